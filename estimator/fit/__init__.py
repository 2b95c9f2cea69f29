"""One identification by maximum likelihood: samples that are used, the problem set up, fit, conclusion, estimates. It imports
`problem`, `optimisation`, `validation` and `omitted_errors`, `rotor`, `machine` and its `checks`, `bearings`, `phasors`, and
`statics` for oil films; its result, an `Identification`, is what everything above works on.
"""
