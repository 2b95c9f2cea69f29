"""Alignment of couplings on oil films over several runs: what healthy machines vary by, changes against a baseline, what is
allowed. It imports `updated_model`, `statics`, `fit` with its `problem` and `validation`, `machine` and
`bearings`; diagnosis and the service tell what it finds.
"""
