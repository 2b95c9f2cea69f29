"""The train at rest on its oil films: static loads, journals' positions, and the films' coefficients that follow from them.
It imports `bearings`, `films`, `machine`, `modes` and `rotor`; a machine document comes in, and equilibria over speed go to
reports, coefficients with their derivatives to the fit.
"""
