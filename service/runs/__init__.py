"""Runs: opened while samples are stored, closed with the samples that belong to them, rebuilt with late ones. It imports
`replication` and `resilience`; a closed run queues a job for `identification`."""
