"""Simulated plants and coast-downs, for tests, benchmarks, the library, and sources that publish without a machine. It imports
`rotor`, `phasors`, `machine`, `bearings`, `statics`, `runs` and `trends`; nothing that assesses real machines imports it.
"""
