"""Joint calibration: what is known afterwards, what later fits make of it, and what is refused before a fit."""

import numpy as np
import pytest
from msgspec.structs import replace

from benchmarks.calibration.rotor_kit import by_least_squares, by_model, folds, gathered, kit
from benchmarks.calibration.simulated_kit import SimulatedKit
from estimator.calibration.calibrate import Calibrated, calibrate
from estimator.calibration.calibration_runs import CalibrationImpossible, CalibrationRun, check_runs
from estimator.calibration.unbalance_since import unbalance_since
from estimator.calibration.undetermined import distinct_speeds
from estimator.fit.fit_samples import NotEnoughData
from estimator.fit.identify import identify
from estimator.machine.document import parse_machine

RUNS = 8


@pytest.fixture(scope="module")
def plant() -> SimulatedKit:
    """A simulated rotor kit that differs from its document."""
    return SimulatedKit(3)


@pytest.fixture(scope="module")
def runs(plant: SimulatedKit) -> list[CalibrationRun]:
    """Eight mountings with known unbalances."""
    measured = [plant.run(plant.trial(number)) for number in range(RUNS)]
    return [CalibrationRun(f"run-{k}", one, (f"run-{k}",) * one.speed.size, steady=True) for k, one in enumerate(measured)]


@pytest.fixture(scope="module")
def calibrated(plant: SimulatedKit, runs: list[CalibrationRun]) -> Calibrated:
    """The kit calibrated by them."""
    return calibrate(plant.machine, runs)


def test_gains_are_found_within_their_errors(plant: SimulatedKit, calibrated: Calibrated) -> None:
    found = calibrated.machine.calibration
    assert calibrated.accepted
    assert calibrated.unique
    assert found is not None
    for channel, gain in zip(plant.machine.channels, plant.gain, strict=True):
        for part, true in (("real", gain.real - 1.0), ("imaginary", gain.imag)):
            place = found.parameters.index(f"probe.{channel}.gain.{part}")
            assert abs(found.values[place] - true) < 4.0 * found.covariance[place][place] ** 0.5


def test_what_three_speeds_cannot_determine_is_held_and_said(calibrated: Calibrated) -> None:
    assert "3 speeds cannot determine 16 bearing terms: held at the document's values, within 20 %" in calibrated.remarks


def test_the_document_holds_the_calibration_with_its_provenance(calibrated: Calibrated) -> None:
    again = parse_machine(calibrated.machine.model_dump(mode="json"))
    assert again == calibrated.machine
    assert again.calibration is not None
    assert [one.name for one in again.calibration.runs] == [f"run-{k}" for k in range(RUNS)]
    assert "accepted" in again.calibration.verdict


def test_a_later_change_of_unbalance_lies_in_its_interval(plant: SimulatedKit, calibrated: Calibrated) -> None:
    added = np.array([2.5e-5 * np.exp(0.6j), 0.0])
    found = identify(calibrated.machine, replace(plant.run(added), added=None))
    since = unbalance_since(calibrated.machine, found)
    assert found.accepted, found.verdict
    assert since is not None
    for disc in range(2):
        assert abs(since.value[disc] - added[disc]) < 3.5 * since.standard_error(disc)
    assert since.standard_error(0) < 1e-5
    assert since.angle_error_deg(0) < 60.0


def test_a_later_fit_is_held_and_its_intervals_hold_the_calibration_s_uncertainty(
    plant: SimulatedKit, calibrated: Calibrated
) -> None:
    later = replace(plant.run(np.zeros(2, dtype=complex)), added=None)
    with pytest.raises(NotEnoughData):
        identify(plant.machine, later.pick(np.arange(3) == 0))
    found = identify(calibrated.machine, later.pick(np.arange(3) == 0))
    said = calibrated.machine.calibration
    assert said is not None
    place, own = said.parameters.index("probe.P1X.gain.real"), found.coordinates.index("probe.P1X.gain.real")
    before, after = said.covariance[place][place] ** 0.5, found.covariance[own, own] ** 0.5
    assert 0.5 * before < after <= 1.01 * before
    assert abs(found.point[own] - said.values[place]) < 3.0 * before


def test_the_unbalance_since_needs_a_calibration(plant: SimulatedKit, calibrated: Calibrated) -> None:
    found = identify(calibrated.machine, replace(plant.run(np.zeros(2, dtype=complex)), added=None))
    assert unbalance_since(plant.machine, found) is None


def test_the_measured_kit_is_predicted_better_than_by_least_squares() -> None:
    first = folds(0)[:2]
    model, plain = (gathered([one(held) for held in first]) for one in (by_model, by_least_squares))
    assert model.magnitude_rms < 1.1 * plain.magnitude_rms
    assert model.median_angle_deg < 6.0
    assert 0.4 < model.reduced_chi_square < 1.5
    assert model.covered > 0.9


def test_one_speed_that_jitters_calibrates() -> None:
    machine, whole, conditions = kit()
    condition = np.array(conditions)
    used = np.isin(condition, ["BASE", "A005", "A026", "B009", "B039"]) & (whole.speed < 115.0)
    found = calibrate(machine, [CalibrationRun("slow", whole.pick(used), tuple(condition[used].tolist()), steady=True)])
    assert found.accepted, found.verdict
    assert found.unique
    assert found.machine.calibration is not None
    known = dict(zip(found.machine.calibration.parameters, found.machine.calibration.values, strict=True))
    assert abs(known["disc.D1.unbalance.real"] + 1j * known["disc.D1.unbalance.imaginary"]) < 2e-4


def test_speeds_that_hardly_differ_are_one() -> None:
    assert distinct_speeds(np.array([105.0, 105.01, 105.6, 126.0, 126.4])) == pytest.approx([105.203, 126.2], abs=0.01)
    assert distinct_speeds(np.linspace(100.0, 200.0, 500)).size > 30
    assert distinct_speeds(kit()[1].speed).size == 2


def refused(plant: SimulatedKit, runs: list[CalibrationRun]) -> str:
    with pytest.raises(CalibrationImpossible) as caught:
        calibrate(plant.machine, runs)
    return str(caught.value)


def test_samples_that_are_alike_by_rounding_make_no_copy(plant: SimulatedKit, runs: list[CalibrationRun]) -> None:
    first, second = (one.measurement for one in runs[:2])
    speed, phasor = second.speed.copy(), second.phasor.copy()
    speed[0], phasor[0] = first.speed[0], first.phasor[0]
    check_runs(plant.machine, [runs[0], replace(runs[1], measurement=replace(second, speed=speed, phasor=phasor)), *runs[2:]])
    copy = replace(runs[1], measurement=replace(second, speed=first.speed, phasor=first.phasor, usable=first.usable))
    with pytest.raises(CalibrationImpossible, match="hold the same samples"):
        check_runs(plant.machine, [runs[0], copy, *runs[2:]])


def weighted(run: CalibrationRun, added: np.ndarray | None) -> CalibrationRun:
    measurement = run.measurement
    rows = None if added is None else np.tile(added, (measurement.speed.size, 1)).astype(complex)
    return replace(run, measurement=replace(measurement, added=rows))


def test_impossible_runs_are_refused_with_what_would_be_right(plant: SimulatedKit, runs: list[CalibrationRun]) -> None:
    assert "a calibration needs runs" in refused(plant, [])
    assert "run-1 does not state which trial weights were on" in refused(plant, [runs[0], weighted(runs[1], None)])
    heavy = refused(plant, [runs[0], weighted(runs[1], np.array([48.0, 0.0]))])
    assert "48 kg m on disc D1 (0.8 kg) would move its centre of mass by 60 m: 48 g mm is likely" in heavy
    none = [weighted(one, np.zeros(2)) for one in runs]
    assert "no run has a trial weight" in refused(plant, none)
    still = replace(runs[1].measurement, speed=np.zeros(runs[1].measurement.speed.size))
    assert "run-1: its speed is zero throughout" in refused(plant, [runs[0], replace(runs[1], measurement=still)])
    same = [weighted(one, np.array([1e-5, 0.0])) for one in runs]
    assert "all runs have the same trial weights" in refused(plant, same)


def test_planes_that_were_not_tried_apart_are_remarked(plant: SimulatedKit, runs: list[CalibrationRun]) -> None:
    assert check_runs(plant.machine, runs) == ()
    only = [weighted(one, np.array([1e-5 * k, 0.0])) for k, one in enumerate(runs)]
    assert check_runs(plant.machine, only) == (
        "no trial weight was ever put on disc D2: what it does rests on the model alone",
    )
    together = [weighted(one, np.array([1e-5 * k, 2e-5 * k])) for k, one in enumerate(runs)]
    assert "discs D1, D2 always had weights in the same proportion" in check_runs(plant.machine, together)[0]
