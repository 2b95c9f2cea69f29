"""Runs of several mountings that are said to be of one are told so, and runs of one mounting are not."""

import numpy as np
import pytest
from msgspec.structs import replace

from benchmarks.calibration import simulated_kit
from benchmarks.calibration.simulated_kit import SimulatedKit
from estimator.calibration.calibrate import Calibrated, calibrate, with_named_senses
from estimator.calibration.calibration_runs import CalibrationRun
from estimator.calibration.forgotten_mountings import with_own_mountings

DOUBT = "runs said to be of one mounting do not agree with one unbalance, and would with a mounting of its own for each set"


def measured(seed: int, *, mountings: tuple[str, ...]) -> tuple[SimulatedKit, list[CalibrationRun]]:
    plant = SimulatedKit(seed)
    return plant, [
        CalibrationRun(f"run-{k}", one, (mounting,) * one.speed.size, steady=True)
        for k, mounting in enumerate(mountings)
        for one in [plant.run(plant.trial(k))]
    ]


def calibrated(plant: SimulatedKit, runs: list[CalibrationRun]) -> Calibrated:
    return with_named_senses(plant.machine, runs, calibrate(plant.machine, runs))


@pytest.mark.parametrize("seed", [5, 6])
def test_forgotten_mountings_are_told(seed: int) -> None:
    found = calibrated(*measured(seed, mountings=("one",) * 7))
    assert found.accepted
    assert found.remarks[-1].startswith(DOUBT)


@pytest.mark.parametrize("seed", [5, 6])
def test_runs_of_one_mounting_and_stated_mountings_are_no_doubt(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    found = calibrated(*measured(seed, mountings=tuple("abcdefg")))
    assert not any("mounting of its own" in one for one in found.remarks)
    monkeypatch.setattr(simulated_kit, "MOUNTING_ECCENTRICITY", 0.0)
    monkeypatch.setattr(simulated_kit, "MOUNTING_RUN_OUT", 0.0)
    found = calibrated(*measured(seed, mountings=("one",) * 7))
    assert found.accepted
    assert not any("mounting of its own" in one for one in found.remarks)


def test_each_set_of_weights_gets_a_mounting_where_one_has_several() -> None:
    _, runs = measured(5, mountings=("one", "one", "two"))
    apart = with_own_mountings(runs)
    assert apart is not None
    assert [len(set(run.mounting)) for run in apart] == [1, 1, 1]
    assert len({run.mounting[0] for run in apart}) == 3
    assert with_own_mountings([runs[0], runs[2]]) is None
    one = runs[1].measurement
    added = np.array(one.added)
    added[1:] *= 2.0
    table = replace(runs[1], measurement=replace(one, added=added))
    again = with_own_mountings([table])
    assert again is not None
    assert [name == again[0].mounting[0] for name in again[0].mounting] == [True, False, False]
