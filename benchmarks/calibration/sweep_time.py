"""Time that the calibration of many sweeps takes on one core."""

import time

from benchmarks.calibration.simulated_trains import MountedTrain
from estimator.calibration.calibrate import calibrate

RUNS, SPEEDS = 20, 150
SECONDS_ASKED = 10.0


def seconds_of_sweeps(seed: int = 0) -> float:
    """Return the processor time of a calibration of the motor-pump train, which has eight channels [s]."""
    plant = MountedTrain("motor-pump", seed)
    runs = plant.runs(RUNS, SPEEDS)
    began = time.process_time()
    calibrate(plant.machine, runs)
    return time.process_time() - began
