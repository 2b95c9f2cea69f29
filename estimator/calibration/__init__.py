"""Calibration of a machine from runs with known unbalances: one fit of all of them, whose values and joint covariance a
document then holds; and the unbalance gained since. It imports `fit` with its `problem`, `optimisation` and `validation`,
`machine`, `phasors` and `rotor`; the command `rundown calibrate` and jobs of the service call it.
"""
