"""Answers kept in memory: responses as long as the store did not change, computations for good. It imports `conventions` and
`http`.
"""
