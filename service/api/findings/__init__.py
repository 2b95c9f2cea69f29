"""Identifications, updated models, comparisons, deviations and diagnoses. It imports `conventions`, `cache`, `http`,
`security`, `identification`, `monitoring` with its `assessment` and `rules`, `advice`, `alerts` and `wording`; findings
come from the store, models are computed when they are asked for, and jobs go to the queue of `identification`.
"""
