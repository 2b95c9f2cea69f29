"""Models of bearings, seals and couplings: coefficients and their derivatives over speed from a form's own parameters. They
import the ground floor of `estimator` only; `machine` declares which form a part has, `rotor` and `fit` ask for the
coefficients.
"""
