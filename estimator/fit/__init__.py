"""One maximum-likelihood fit: coordinates, optimiser, multistart, goodness of fit, estimates. It imports `rotor`, `machine`,
`bearings` and `phasors`; its result, an `Identification`, is what everything above works on.
"""
