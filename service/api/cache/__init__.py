"""Caches of the API: responses until the store changes, computed results for good. It imports `conventions` and `http`; the
resources ask it before they read from the store, and it keeps what they answer.
"""
