"""Intervals of a calibration from few mountings are wider than plug-in ones, by less the more mountings there are."""

import numpy as np
import pytest

from benchmarks.calibration.simulated_kit import SPEEDS_RPM, SimulatedKit, later_changes
from estimator.calibration.calibrate import Calibrated, calibrate
from estimator.calibration.calibration_runs import CalibrationRun


def calibrated(mountings: int) -> Calibrated:
    plant = SimulatedKit(5)
    runs = [
        CalibrationRun(f"run-{k}", plant.run(plant.trial(k)), (f"run-{k}",) * len(SPEEDS_RPM), steady=True)
        for k in range(mountings)
    ]
    return calibrate(plant.machine, runs)


def widening(found: Calibrated) -> float:
    """Return the scatter of mountings in the document over that which the runs showed."""
    calibration = found.machine.calibration
    assert calibration is not None
    probes = [one.rms for one in calibration.mounting if one.name.endswith("run_out")]
    return float(np.mean(np.array(probes) / found.sizes.run_out))


def test_few_mountings_widen_and_many_hardly_do() -> None:
    few, many = widening(calibrated(3)), widening(calibrated(12))
    assert 1.04 < few < 1.5
    assert 1.0 < many < 1.04


@pytest.mark.long
def test_intervals_from_three_mountings_hold_on_average() -> None:
    kits = [later_changes(seed, mountings=3) for seed in range(3000, 3030)]
    assert 0.92 <= np.mean([one.covered for one in kits]) <= 0.98
