"""Backup, restore and transfer between databases, and the access that remains valid after a restore. It imports `database`,
`encoding`, `files` and `tables`; commands, the doctor and the checks of backups and secrets use it.
"""
