"""Secrets in files, and secrets encrypted for the database. It imports no other room."""
