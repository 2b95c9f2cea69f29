"""Repositories of the service's own operation: keys, sessions, audit, leases, replicas, retention, stages. They import
`tables`, `database`, `encoding`, `machines`, `findings` and `alerts`; `security`, `replication` and `maintenance` of the
service use them.
"""
