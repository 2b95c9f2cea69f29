"""A plant that the estimator does not know: rotor trains in fluid-film bearings, simulated from their own physics.

Nothing here but `documents` and `scores` imports the estimator, so that no error of its models can hide in the data that
judge it: films come from finite volumes with rupture as a complementarity problem, shafts from beam elements integrated
numerically, sweeps from an integration in time. Plants go to the tests and to the benchmarks, with their truth.
"""
