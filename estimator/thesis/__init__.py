"""Published methods as Lal's thesis (IIT Guwahati) prints them, to be compared with. They import `rotor`, `machine` and the
rooms beside these; `benchmarks/thesis` runs them, the service never does.
"""
