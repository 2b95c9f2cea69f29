"""Files of measuring systems, such as MAT, MDF4, TDMS and UFF 58, as columns by name. It imports the ground floor of the
estimator and the store's clock; `recordings` and the edge read with it.
"""
