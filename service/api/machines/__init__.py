"""Machines: documents, state, timeline, limits, calibrations, slow roll, baselines, and the fleet overview. It imports
`conventions`, `cache`, `runs`, `monitoring` and `identification`.
"""
