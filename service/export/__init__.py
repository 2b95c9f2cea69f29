"""Tables as CSV and Parquet files. It imports no other room; the API and commands write with it."""
