"""Validation of a fit: goodness of fit, what the fit leaves out (deviations of forms and films, forces, errors of channels),
what no machine can have, which parameters the data leave open, whether intervals hold. It imports `optimisation`, `problem`,
`rotor`, `machine`, `bearings`, `modes` for limits of damping and `statics` for oil films; `fit` draws conclusions from it.
"""
