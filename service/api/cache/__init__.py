"""Caches of the API: responses until the store changes, computed results for good. It imports `conventions` and `http`."""
