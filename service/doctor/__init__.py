"""Examines a deployment from outside: settings, database, certificates, and endpoints open to strangers. It may import every
room but `commands`, which prints its results.
"""
