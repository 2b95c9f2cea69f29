"""Tables as CSV and Parquet files. It imports no other room; the API, commands and recordings write with it."""
