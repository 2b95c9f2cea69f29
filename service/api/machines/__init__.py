"""Machines: documents, state, timeline, limits, calibrations, slow roll, baselines, and the fleet at a glance. It imports
`conventions` and `cache`, `runs`, `monitoring` and `identification`.
"""
