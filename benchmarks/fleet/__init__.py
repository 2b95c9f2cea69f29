"""Simulated fleets: how often the service calls a healthy machine misaligned, how soon it sees a change, what it names it.

python -m benchmarks.fleet [--short]
"""
