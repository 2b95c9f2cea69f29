"""Caches of the API: responses until the store changes, computed results for good, and the process that computes long ones.
It imports `conventions`, `http` and `workers`; the resources ask it before they read from the store, and it keeps what they
answer.
"""
