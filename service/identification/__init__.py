"""Identification jobs: built, scheduled, computed in worker processes, and their results filed. It imports `configuration` and
`replication`; a filed identification is assessed by `monitoring`."""
