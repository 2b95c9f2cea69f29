"""Samples, runs, orbits and quality for reading, and the ingestion of samples. It imports `conventions`, `ingest` for the
ingestion and `identification` for the choice of slow-roll vectors.
"""
