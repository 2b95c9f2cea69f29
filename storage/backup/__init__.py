"""Backup, restore and transfer between databases, and who gets in behind a restore. It imports `database`, `tables` and
`operation`; only commands use it.
"""
