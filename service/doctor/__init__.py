"""Looks at a deployment from outside: settings, database, certificates, and what a stranger could reach. It may import every
room but `commands`, which prints what it finds.
"""
