"""Oil films of journal bearings: Reynolds' equation on single pads, tables of its solutions over the journal's position, whole
films with their stiffness and damping, and positions of equilibrium. They import the ground floor of `estimator` only and know
nothing of machine documents: geometry, oil and positions come as numbers, and bearing models ask for forces and coefficients.
The equation is that of O. Reynolds, Phil. Trans. R. Soc. 177 (1886) 157.
"""
