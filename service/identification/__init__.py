"""Identification jobs: built, scheduled, computed in worker processes, and their results filed. It imports `workers`,
`monitoring`, `configuration`, `replication` and `resilience`; jobs come from closed runs and the API, and a filed
identification is queued for its assessment.
"""
