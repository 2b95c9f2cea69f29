"""Zenoh sessions, and access control on them. It imports `configuration` and `wire`; commands open sessions here, and hand
them to sources, ingest and delivery.
"""
