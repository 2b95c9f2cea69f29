"""Maintenance while the service runs: retention, disk, backups and damage. It imports `runs`, `replication`, `resilience` and
`configuration`; it deletes from the store what has outlived its time, reads its files and backups, and reports in metrics and
the log."""
