"""Maintenance while the service runs: retention, disk, backups and damage. It imports `runs`, `replication`, `resilience` and
`configuration`."""
