"""Benchmarks of what breaks services: kills, attacks, rubbish, documents and numbers that are too large, hours of load.

`python -m benchmarks.faults` is the long form of `tests/faults`; each other module is a command, but for `large_documents`.
"""
