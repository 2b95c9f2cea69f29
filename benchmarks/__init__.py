"""Benchmarks: each command prints the figures it measured beside the figures asked for.

The modules here measure the service and its store; `chain`, `closed_loop` and `serving` set up what they measure. Rooms:
`estimator` (accuracy, coverage and cost of the science), `alignment`, `calibration` and `fluid_film` (the same of their
subjects), `faults` (kills, attacks, hours of load), `fleet` (false alarms and detection over months), `thesis` (its
experiments run again, by chapter).
"""

import os

# As the commands do, before numpy is loaded: the matrices are small, and more threads wait for one another.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
