"""Backup, restore and transfer between databases, and the access that remains valid after a restore. It imports `database`,
`tables` and `operation`; only commands use it."""
