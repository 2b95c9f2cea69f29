"""The history of parameters: baseline scatter, covariates, deviations, control charts, drift. It imports `machine` for names
and works on points, which the store keeps; `diagnosis` and the service's monitoring ask it.
"""
