"""Repositories of the service's own operation: keys, sessions, audit, leases, replicas, retention, stages. They import
`tables`, `database` and other repositories; `security`, `replication` and `maintenance` of the service use them."""
