"""Samples, runs, orbits and quality as they are read, and samples as they are sent. It imports `conventions`, `ingest` for
what is sent and `identification` for what is asked again.
"""
