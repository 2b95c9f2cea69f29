"""One run of phasors assessed without a fitted model: noise, quality flags, beating, slow roll, orbits. It imports `machine`,
`rotor` and `modes`; what is usable of a run goes to `identification`.
"""
