"""Simulated plants and coast-downs, for tests, the demo and the design of experiments. It imports `rotor`, `modes`, `phasors`
and `machine`; nothing that judges real machines imports it.
"""
