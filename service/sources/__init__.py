"""Publishers of samples: live, recorded and simulated, with the logs from which they answer replay queries. It imports
`wire`, `configuration` and `export`; what it publishes arrives in `ingest`.
"""
