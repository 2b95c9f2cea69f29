"""Several processes on one database: leases, and each process's share of the work. It imports `configuration` and
`resilience`; leases stand in the database, and whoever stores or computes asks here first.
"""
