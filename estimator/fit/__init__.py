"""One maximum-likelihood fit: optimiser, multistart, goodness of fit, estimates. It imports its `problem`, `rotor`, `machine`,
`bearings`, `phasors`, `modes` for limits of damping and `statics` for oil films; its result, an `Identification`, is what
everything above works on.
"""
