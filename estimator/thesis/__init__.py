"""Published methods of M. Lal's thesis as printed, to be compared with. They import `rotor`, `machine` and the ground floor;
`benchmarks/thesis` runs them, the service never does.
"""
