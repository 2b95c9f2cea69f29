"""Published methods as Lal's thesis (IIT Guwahati) prints them, for comparison. They import `rotor`, `modes`, `phasors`,
`machine` and `bearings`; `benchmarks/thesis` runs them, of the service only the command that prints a comparison.
"""
