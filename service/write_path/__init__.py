"""The write path of samples: batches become stored samples, each exactly once, by numbering, checks, and short transactions
that include all consequences. It imports `runs`, `replication`, `resilience` and `wire`; `ingest` and `recovery`
pass it the batches that arrived.
"""
