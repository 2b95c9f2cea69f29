"""Balance grades, and field balancing by influence coefficients: measured by trial runs, taken from a model or from both,
corrections in planes with holes or blades, and the check run after them. It imports `updated_model`, `fit`, `machine`,
`phasors` and `rotor`; the command `rundown balance`, the API and `service/balancing` call it.
"""
