"""The train at rest on its oil films: static loads, journals' positions, and the films' coefficients that follow from them.
It imports `films`, `machine`, `modes` and `rotor`; a machine document comes in, and equilibria over speed go to reports and,
later, to the fit of film parameters.
"""
