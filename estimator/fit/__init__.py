"""One maximum-likelihood fit: coordinates, optimiser, multistart, goodness of fit, estimates. It imports `rotor`, `machine`,
`bearings`, `phasors`, `modes` for limits of damping and `statics` for oil films; its result, an `Identification`, is what
everything above works on.
"""
