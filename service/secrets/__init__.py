"""Secrets in files, and secrets sealed for the database. It imports no other room."""
