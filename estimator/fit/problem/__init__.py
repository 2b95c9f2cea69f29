"""The problem of a fit: data, train, coordinates and prior, with residuals and their derivatives. It imports `rotor`,
`machine`, `bearings`, `phasors` and `statics` for oil films; `fit` solves it, and predictions compute in its coordinates.
"""
