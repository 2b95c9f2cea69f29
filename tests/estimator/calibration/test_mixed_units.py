"""Weights of which some are stated in another unit: doubted beforehand, named where nothing else explains the runs."""

import numpy as np
import pytest
from msgspec.structs import replace

from benchmarks.calibration.simulated_kit import SimulatedKit
from estimator.calibration.calibrate import Calibrated, calibrate, with_named_senses
from estimator.calibration.calibration_runs import CalibrationRun
from estimator.calibration.mixed_units import explaining_units, mixed_units
from estimator.phasors.measurement import joined
from estimator.units import KILOGRAM_METRES

DISCS = ("D1", "D2")
INCH = KILOGRAM_METRES["g in"] / KILOGRAM_METRES["g mm"]


@pytest.fixture(scope="module")
def runs() -> list[CalibrationRun]:
    """Seven mountings of a simulated kit: none, then a weight on one disc after the other."""
    plant = SimulatedKit(5)
    measured = [plant.run(plant.trial(number)) for number in range(7)]
    return [CalibrationRun(f"run-{k}", one, (f"run-{k}",) * one.speed.size, steady=True) for k, one in enumerate(measured)]


def told(run: CalibrationRun, factor: float, unit: str = "") -> CalibrationRun:
    added = factor * np.asarray(run.measurement.added)
    return replace(run, measurement=replace(run.measurement, added=added), units=(unit, unit) if unit else ())


def test_weights_that_are_alike_are_not_doubted(runs: list[CalibrationRun]) -> None:
    assert mixed_units(DISCS, runs) is None
    assert mixed_units(DISCS, [*runs[:-1], told(runs[-1], 8.0)]) is None
    assert mixed_units(DISCS, [*runs[:-1], told(runs[-1], 5000.0)]) is None, "no two units differ so"
    assert mixed_units(DISCS, runs[:1]) is None


def test_heavier_weights_are_named_with_the_units_that_explain_them(runs: list[CalibrationRun]) -> None:
    found = mixed_units(DISCS, [*runs[:2], told(runs[2], INCH), *runs[3:]])
    assert found is not None
    assert found.ratio == pytest.approx(INCH)
    assert [row.any() for row in found.doubted] == [False, False, True, False, False, False, False]
    assert found.units[0] == ("g in", "g mm")
    assert found.remark.startswith("the weights of run-2 are 25 times as heavy as the others: are units mixed (such as g mm")
    of_disc = mixed_units(DISCS, [told(run, INCH) if k % 2 else run for k, run in enumerate(runs)])
    assert of_disc is not None
    assert of_disc.words == "the weights of run-1, run-3, run-5"


def test_the_units_that_were_given_come_first(runs: list[CalibrationRun]) -> None:
    given = [*(told(run, 1.0, "g in") for run in runs[:-1]), told(runs[-1], 1.1 * INCH, "oz in")]
    found = mixed_units(DISCS, given)
    assert found is not None
    assert found.units[0] == ("oz in", "g in")


def test_one_weight_that_is_far_too_light_is_named_rather_than_all_others(runs: list[CalibrationRun]) -> None:
    """48 said in g mm where kg mm were meant; all units are known, and none is lighter by a thousand than g mm."""
    given = [told(run, 1e-3 if k == 2 else 1.0, "g mm") for k, run in enumerate(runs)]
    found = mixed_units(DISCS, given)
    assert found is not None
    assert found.remark.startswith(
        "the weights of run-2 are 1000 times lighter than the others: are units mixed (such as kg mm"
    )
    assert found.units[0] == ("g mm", "kg mm")
    right = np.asarray(runs[2].measurement.added)
    words = explaining_units(DISCS, given, lambda other: np.allclose(np.asarray(other[2].measurement.added), right))
    assert words == "it fits with the weights of run-2, which were given in g mm, in kg mm"


def test_what_explains_the_runs_is_named_and_nothing_where_nothing_does(runs: list[CalibrationRun]) -> None:
    mixed = [*runs[:2], told(runs[2], INCH), *runs[3:]]
    right = np.asarray(runs[2].measurement.added)
    words = explaining_units(DISCS, mixed, lambda other: np.allclose(np.asarray(other[2].measurement.added), right))
    assert words == "it fits with the weights of run-2, which were given in g in, in g mm"
    assert explaining_units(DISCS, mixed, lambda _: False) == ""
    assert explaining_units(DISCS, runs, lambda _: True) == ""


def calibrated(runs: list[CalibrationRun]) -> Calibrated:
    machine = SimulatedKit(5).machine
    return with_named_senses(machine, runs, calibrate(machine, runs))


@pytest.mark.parametrize("which", [(2,), (1, 3, 5)])
def test_a_calibration_with_mixed_units_is_refused_and_names_them(runs: list[CalibrationRun], which: tuple[int, ...]) -> None:
    found = calibrated([told(run, INCH, "g in") if k in which else told(run, 1.0, "g mm") for k, run in enumerate(runs)])
    assert not found.accepted
    named = ", ".join(f"run-{k}" for k in which)
    assert f"it fits with the weights of {named}, which were given in g in, in g mm" in found.verdict


def test_a_calibration_with_one_weight_too_light_names_it(runs: list[CalibrationRun]) -> None:
    found = calibrated([told(run, 1e-3 if k == 2 else 1.0, "g mm") for k, run in enumerate(runs)])
    assert "the weights of run-2 are 1000 times lighter than the others" in "; ".join(found.remarks)
    assert not found.accepted
    assert "it fits with the weights of run-2, which were given in g mm, in kg mm" in found.verdict


def test_one_weight_of_a_table_is_named_by_its_mounting(runs: list[CalibrationRun]) -> None:
    whole = [told(run, 1e-3 if k == 2 else 1.0, "g mm") for k, run in enumerate(runs)]
    table = CalibrationRun(
        "table.csv",
        joined([run.measurement for run in whole]),
        tuple(name for run in whole for name in run.mounting),
        steady=True,
        units=("g mm", "g mm"),
    )
    found = mixed_units(DISCS, [table])
    assert found is not None
    assert found.words == "the weights of run-2 in table.csv"
    assert found.units[0] == ("g mm", "kg mm")
    assert mixed_units(DISCS, [replace(table, measurement=joined([run.measurement for run in runs]))]) is None
