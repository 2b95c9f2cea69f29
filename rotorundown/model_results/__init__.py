"""Results of a model as the library gives them: tables that fit a screen, and data frames, in the units of plants. They import
`environment` and `estimator`; each keeps the estimator's own object, which is in SI units, as `si`.
"""
