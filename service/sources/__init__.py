"""Publishers of samples, live, recorded and simulated, with the logs from which they reply to replay queries. They import
`wire`, `configuration` and `export`; what they publish arrives in `ingest`."""
