"""Files of a store on a disk: readable by their owner only, locked by whatever name, and what SQLite's main file and its
write-ahead log hold. It imports nothing of Rundown; `database` watches its open files with it, and secrets and exports make
private files.
"""
