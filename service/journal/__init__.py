"""Batches to stored samples, once each: numbered, checked, written in short transactions together with all that follows. It
imports `runs`, `replication`, `resilience` and `wire`; `ingest` and `recovery` hand it what arrived.
"""
