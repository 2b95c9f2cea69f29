"""Several processes on one database: leases, and each one's share of the work. It imports `configuration`."""
