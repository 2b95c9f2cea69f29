"""Later fits that start from a calibrated document: refused, or with wider intervals, where the run contradicts it."""

import re
from collections.abc import Sequence

import numpy as np
import pytest
from msgspec.structs import replace

from benchmarks.calibration.simulated_kit import SimulatedKit
from estimator.arrays import Complexes
from estimator.calibration.calibrate import calibrate
from estimator.calibration.calibrated_document import with_gain_drift
from estimator.calibration.calibration_runs import CalibrationRun
from estimator.calibration.unbalance_since import unbalance_since
from estimator.fit.estimates import CONFIDENCE_95
from estimator.fit.identification import Identification
from estimator.fit.identify import identify
from estimator.machine.document import Machine

RUNS = 8


class Kit:
    """A simulated kit with its calibrated document, whose chains may change afterwards."""

    def __init__(self, seed: int) -> None:
        self.plant = SimulatedKit(seed)
        measured = [self.plant.run(self.plant.trial(number)) for number in range(RUNS)]
        runs = [CalibrationRun(f"{k}", one, (f"{k}",) * one.speed.size, steady=True) for k, one in enumerate(measured)]
        self.calibrated: Machine = calibrate(self.plant.machine, runs).machine
        self.gain = self.plant.gain.copy()

    def later(self, added: Complexes, *, gains: Sequence[float] = (1.0,) * 4) -> Identification:
        """Identify a later run, with gains that have changed since."""
        self.plant.gain = self.gain * np.array(gains)
        return identify(self.calibrated, replace(self.plant.run(added), added=None))


@pytest.fixture(scope="module")
def calibrated_kit() -> Kit:
    return Kit(3)


@pytest.fixture
def kit(calibrated_kit: Kit) -> Kit:
    """The kit with noise of its own for each test: some draws of a changed chain are accepted, with widened intervals."""
    calibrated_kit.plant.rng = np.random.default_rng(8)
    return calibrated_kit


def test_a_run_of_the_calibrated_machine_is_accepted(kit: Kit) -> None:
    found = [kit.later(kit.plant.trial(number)) for number in range(6)]
    assert all(one.accepted for one in found), [one.verdict for one in found]
    assert sum("widened" in one.verdict for one in found) <= 1


def test_a_chain_that_has_changed_is_refused_and_named(kit: Kit) -> None:
    found = kit.later(np.zeros(2, dtype=complex), gains=(1.0, 1.3, 1.0, 1.0))
    assert not found.accepted
    assert "the run contradicts the document's calibration" in found.verdict
    assert "furthest from it, by " in found.verdict
    assert "most of it at P1Y" in found.verdict
    assert "calibrate again or take `calibration` out" in found.verdict


def test_what_is_accepted_of_a_machine_that_has_changed_a_little_has_intervals_that_hold(kit: Kit) -> None:
    held = []
    for number in range(12):
        added = kit.plant.trial(number)
        found = kit.later(added, gains=(1.0, 1.0 + 0.02 * number, 1.0, 1.0))
        since = unbalance_since(kit.calibrated, found)
        assert since is not None
        if found.accepted:
            error = since.value - added
            parts = np.stack([error.real, error.imag], axis=1).reshape(-1)
            held += (np.abs(parts) < CONFIDENCE_95 * np.sqrt(np.diag(since.covariance))).tolist()
    assert len(held) >= 12
    assert np.mean(held) > 0.85


def test_gains_that_drift_as_far_as_is_allowed_for_are_accepted_with_intervals_that_hold(kit: Kit) -> None:
    constant, drifting = kit.calibrated, with_gain_drift(kit.calibrated, 0.03)
    held, refused = [], {constant.id: 0, "drifting": 0}
    for number in range(12):
        gains = [1.0] * 4
        gains[number % 4] = 1.07
        added = kit.plant.trial(number)
        kit.plant.gain = kit.gain * np.array(gains)
        later = replace(kit.plant.run(added), added=None)
        refused[constant.id] += not identify(constant, later).accepted
        found = identify(drifting, later)
        refused["drifting"] += not found.accepted
        since = unbalance_since(drifting, found)
        assert since is not None
        error = since.value - added
        parts = np.stack([error.real, error.imag], axis=1).reshape(-1)
        held += (np.abs(parts) < CONFIDENCE_95 * np.sqrt(np.diag(since.covariance))).tolist()
    assert refused["drifting"] <= 1 < refused[constant.id], refused
    assert np.mean(held) > 0.85


@pytest.mark.parametrize("place", [0, *(pytest.param(one, marks=pytest.mark.long) for one in (1, 2)), 3])
def test_a_chain_that_has_changed_is_distinguished_from_the_others_with_its_new_gain(kit: Kit, place: int) -> None:
    gains = [1.0] * 4
    gains[place] = 1.3
    found = kit.later(kit.plant.trial(1), gains=gains)
    assert not found.accepted
    told = re.search(r"the gain of (\w+) fits best at ([\d.]+) times its calibrated value", found.verdict)
    assert told is not None, found.verdict
    assert told[1] == kit.plant.machine.channels[place]
    assert float(told[2]) == pytest.approx(1.3, abs=0.1)


def test_a_small_change_of_a_chain_is_left_open_in_the_intervals(kit: Kit) -> None:
    def width(found: Identification) -> float:
        since = unbalance_since(kit.calibrated, found)
        assert since is not None
        return float(np.sqrt(np.trace(since.covariance)))

    widened = []
    for number in range(8):
        added = kit.plant.trial(number)
        unchanged, changed = kit.later(added), kit.later(added, gains=(1.0, 1.0, 1.05, 1.0))
        if "the gain of P2X fits best at" in changed.verdict and changed.accepted:
            widened.append(width(changed) / width(unchanged))
    assert widened
    assert min(widened) > 1.05
