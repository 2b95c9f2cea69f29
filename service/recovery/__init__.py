"""Recovery of sequence gaps from the logs of the sources, without blocking on any. It imports `write_path`, `replication`,
`resilience` and `wire`; `ingest` reports gaps to it, and recovered batches are stored like all others.
"""
