"""Oil films of journal bearings: solutions on single pads, fixed or tilting, tables of them over the journal's position, whole
films with their stiffness and damping, and positions of equilibrium. They import the ground floor of `estimator` only and know
nothing of machine documents; geometry, oil and positions come as numbers, and `statics` asks for forces and coefficients.
"""
