"""Several processes on one database: leases, and each process's share of the work. It imports `configuration`."""
