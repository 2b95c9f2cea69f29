"""Zenoh sessions, and who may do what on them. It imports `configuration` and `wire`; sources, ingest and delivery get their
sessions from here.
"""
