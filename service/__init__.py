"""Rundown as a running service: wire, ingest, run collection, identification jobs, alerts, REST, simulator, commands."""
