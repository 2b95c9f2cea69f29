"""Assessment of a machine's newest runs: a pure function, computed in a worker process from a context that was loaded before.
It imports `rules` and `alerts`; `monitoring` loads its context, and applies its outcome in a transaction.
"""
