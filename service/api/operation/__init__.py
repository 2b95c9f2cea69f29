"""Health, metrics, replicas, stages, the audit trail, the built page and the documentation. It imports `conventions`, `http`
and `replication`.
"""
