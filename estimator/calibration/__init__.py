"""Calibration of a machine from runs with known unbalances: one fit of all of them, whose values and joint covariance a
document then holds; influence coefficients measured by trial runs, and corrections from them. It imports `updated_model` and
what lies below; the commands `rundown calibrate` and `rundown balance` call it.
"""
