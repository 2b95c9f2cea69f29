"""Figures of the estimator: accuracy, coverage, cost. `python -m benchmarks.estimator` prints those of the fit; each other
module is a command, but for `trains`, whose trains and data several of them identify.
"""
