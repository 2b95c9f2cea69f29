"""Simulated plants and coast-downs, for tests, the demo and the design of experiments. It imports `rotor`, `phasors`,
`machine`, `bearings`, `statics`, `runs` and `trends`; nothing that assesses real machines imports it.
"""
