"""The database itself: opening, claim, schema, transactions, damage, disk, and which plants a session sees. It imports
`tables` and no repository; every repository works in its sessions.
"""
