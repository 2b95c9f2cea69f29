"""Samples, runs, orbits and quality for reading, and the ingestion of samples. It imports `conventions`, `journal` for what
is sent, `wire` and `identification` for the choice of slow-roll vectors.
"""
