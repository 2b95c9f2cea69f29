"""Retention, disk, backups and damage: looked after while the service runs. It imports `runs`, `replication`, `resilience`
and `configuration`.
"""
