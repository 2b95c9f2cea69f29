"""Health, metrics, replicas, stages, the audit trail, the built page and the documentation. It imports `conventions`, `http`,
`security`, `replication`, `configuration` and `wire`; figures come from the running parts and the store, and go to people and
to monitoring systems.
"""
