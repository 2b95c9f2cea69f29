"""From batches to stored samples, each exactly once: numbering, checks, and short transactions that include all consequences.
It imports `runs`, `replication`, `resilience` and `wire`; `ingest` and `recovery` pass it the batches that arrived."""
