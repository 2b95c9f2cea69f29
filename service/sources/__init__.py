"""Publishers of samples, live and simulated, with the logs from which they reply to replay queries. They import
no other room of the service; what they publish arrives in `ingest`."""
