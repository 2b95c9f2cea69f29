"""Identifications, updated models, comparisons, deviations and diagnoses. It imports `conventions`, `cache`, `identification`
and `monitoring`.
"""
