"""Identification and calibration jobs: built, scheduled, computed in worker processes, and their results filed. It imports
`workers`, `monitoring`, `configuration`, `replication` and `resilience`, and from `balancing` the weights of stored runs; jobs
come from closed runs and the API, and a filed identification is queued for its assessment.
"""
