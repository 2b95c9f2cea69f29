"""Calibration of a machine from runs with known unbalances: one fit of all of them, whose values and joint covariance a
document then holds. It imports `fit` and what lies below; the command `rundown calibrate` calls it.
"""
