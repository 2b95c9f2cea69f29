"""Zenoh sessions, and access control on them. It imports `configuration` and `wire`; sources, ingest and delivery get their
sessions from here."""
