"""The train as a mechanical system: elements, assembly, unknowns, exact condensation, response and its derivatives. It
imports `machine` and `bearings`; `modes`, `fit` and `updated_model` compute with its matrices.
"""
