"""Secrets in files, and secrets encrypted for the database. It imports no other room; `configuration` and
commands read files with it, `delivery` and `http` encrypt with it what the store keeps.
"""
