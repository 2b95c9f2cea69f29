"""Worker processes, local or on Dask: pools, executors, limits of time and memory. They import `configuration` and
`resilience`; the rooms of identification and monitoring give them tasks.
"""
