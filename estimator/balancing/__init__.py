"""Balance grades, and balancing by influence coefficients: of an identified model, measured by trial runs, or of both; the
corrections in planes with holes or blades, and the check run after them. It imports `updated_model`, `fit`, `machine`,
`phasors` and `rotor`; the library, `rundown balance` and `rundown model`, the API, reports and `service/balancing` call it.
"""
