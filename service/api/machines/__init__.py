"""Machines: documents, state, timeline, limits, calibrations, slow roll, field balancings, baselines, and the fleet overview.
It imports `conventions`, `cache`, `http`, `security`, `runs`, `monitoring` and its `rules`, `identification`, `balancing`,
`alerts`, `reports` and `wording`; documents and limits go to the store, from which ingest and monitoring take them, and states
and overviews come from there.
"""
