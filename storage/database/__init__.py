"""The database itself: opening, claim, schema, transactions, damage, disk space, and the plants that a session sees. It
imports `files`, `tables` and `encoding` and no repository; every repository works in its sessions.
"""
