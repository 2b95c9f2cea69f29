"""Worker processes, local or on Dask: pools, executors, limits of time and memory. They import `configuration` and
`resilience`; identification, monitoring, reports and the API's cache give them tasks.
"""
