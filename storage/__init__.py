"""The store of Rundown: tables, migrations and repositories, on SQLite by default and PostgreSQL by URL.

It may import the data types of `estimator`, never `service`. Rows come from ingest and workers and go to the API.
"""
