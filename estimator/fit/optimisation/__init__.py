"""The search for the most likely parameters: damped least squares from one start and from several, weights and outliers found
anew between passes, and parameters that are fitted for the due uncertainty of others. It imports `problem`, `rotor`, `machine`
and `phasors`; it is given a problem, and its result, a `FitResult`, is validated and then concluded from in `fit`.
"""
