"""Speed readings to operating states and runs; which samples a run keeps, and what it covers. It imports `machine` and
`phasors`, and assembles no rotor; the service's collector works by it while samples are stored.
"""
