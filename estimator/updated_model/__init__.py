"""Predictions from an identified machine with their uncertainty: critical speeds, amplification, loads. It imports
`fit`, `modes` and what lies below; derived quantities go to the store, the rest is answered when it is asked for.
"""
