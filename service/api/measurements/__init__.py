"""Samples, runs, orbits, vibration and quality for reading, and the ingestion of samples. It imports `conventions`, `http`,
`security`, `write_path` for what is sent, `wire`, `runs` for those made of dwells, and `identification` for the choice of
slow-roll vectors; samples go to the ingest thread, and runs come from the store.
"""
