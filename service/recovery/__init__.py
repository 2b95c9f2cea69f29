"""Sequence gaps fetched again from the logs of their sources, without waiting for any. It imports `journal`, `resilience` and
`wire`; `ingest` tells it of gaps, and what it fetches goes the way of all batches.
"""
