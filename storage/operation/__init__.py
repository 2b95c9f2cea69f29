"""Repositories of what runs the service: keys, sessions, audit, leases, replicas, retention, stages. They import `tables`,
`database` and other repositories; `security`, `replication` and `maintenance` of the service use them.
"""
