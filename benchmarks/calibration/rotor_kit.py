"""The measured rotor kit, calibrated anew without some of its conditions, and their known unbalances estimated as held out."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from msgspec.structs import replace

from estimator.arrays import Complexes, Floats
from estimator.calibration.calibrate import calibrate
from estimator.calibration.calibration_runs import CalibrationRun
from estimator.calibration.unbalance_since import unbalance_since
from estimator.fit.estimates import CONFIDENCE_95
from estimator.fit.identify import identify
from estimator.machine.document import Machine
from estimator.phasors.measurement import Measurement
from formats.files.document_files import read_machine
from formats.recordings.recorded_runs import read_calibration_runs

ROOT = Path(__file__).resolve().parents[2]
DOCUMENT = ROOT / "examples" / "rk4-rotor-kit-four-probes.yaml"
RUNS = ROOT / "examples" / "recordings" / "rk4_unbalance_1x.csv"
FOLDS = 5
LARGE = 24e-6
"""Unbalance from which on its angle is judged [kg m]."""
BETWEEN_SPEEDS = 115.0
"""Speed between the kit's two speeds [rad/s]."""


@dataclass(frozen=True)
class HeldOut:
    """Unbalances of held-out records, R records of P discs.

    Attributes:
        true: Known unbalances (R, P) [kg m].
        found: Estimated ones (R, P) [kg m].
        covariance: Covariance (R, 2P, 2P) of the estimates [kg² m²]; None of a method that states none.
    """

    true: Complexes
    found: Complexes
    covariance: Floats | None = None

    @property
    def magnitude_rms(self) -> float:
        """Return the rms of the magnitude's error [kg m]."""
        return float(np.sqrt(np.mean((np.abs(self.found) - np.abs(self.true)) ** 2)))

    @property
    def median_angle_deg(self) -> float:
        """Return the median of the angle's error where the unbalance is large [°]."""
        large = np.abs(self.true) >= LARGE * (1 - 1e-9)
        return float(np.median(np.abs(np.degrees(np.angle(self.found[large] / self.true[large])))))

    @property
    def reduced_chi_square(self) -> float:
        """Return χ² of the errors over their number [-]."""
        return float(np.mean([e @ np.linalg.solve(c, e) / e.size for e, c in self._errors]))

    @property
    def covered(self) -> float:
        """Return the part of the 95 % intervals that hold the truth [-]."""
        return float(np.mean([np.abs(e) <= CONFIDENCE_95 * np.sqrt(np.diag(c)) for e, c in self._errors]))

    @property
    def _errors(self) -> Iterator[tuple[Floats, Floats]]:
        error = np.stack([(self.found - self.true).real, (self.found - self.true).imag], axis=-1)
        covariance = () if self.covariance is None else self.covariance
        return zip(error.reshape(len(error), -1), covariance, strict=True)


@cache
def kit() -> tuple[Machine, Measurement, tuple[str, ...]]:
    """Return the document, all records and the condition of each."""
    machine = read_machine(DOCUMENT)
    [run], _ = read_calibration_runs(machine, [RUNS])
    return machine, run.measurement, run.mounting


def folds(seed: int) -> list[frozenset[str]]:
    """Return the conditions held out in each fold of a random split."""
    names = np.random.default_rng(seed).permutation(sorted(set(kit()[2])))
    return [frozenset(names[first::FOLDS].tolist()) for first in range(FOLDS)]


def by_model(held: frozenset[str], *, used: frozenset[str] | None = None) -> HeldOut:
    """Estimate held-out records with the document calibrated by the others, or by some of them."""
    _, whole, conditions = kit()
    condition, calibrated = np.array(conditions), _calibrated(held, used)
    found, covariance, places = [], [], np.flatnonzero(np.isin(condition, list(held)))
    for place in places:
        record = replace(whole.pick(np.arange(condition.size) == place), added=None)
        since = unbalance_since(calibrated, identify(calibrated, record))
        if since is None:
            raise RuntimeError("the calibrated document holds no calibration")
        found.append(since.value)
        covariance.append(since.covariance)
    return HeldOut(_added(whole)[places], np.array(found), np.array(covariance))


def by_condition(held: frozenset[str], *, used: frozenset[str] | None = None) -> tuple[HeldOut, int]:
    """Estimate held-out conditions, all records of one at both speeds in one fit; return the refused ones' number beside."""
    _, whole, conditions = kit()
    condition, calibrated = np.array(conditions), _calibrated(held, used)
    true, found, covariance = [], [], []
    for name in sorted(held):
        records = condition == name
        fitted = identify(calibrated, replace(whole.pick(records), added=None))
        since = unbalance_since(calibrated, fitted)
        if fitted.accepted and since is not None:
            true.append(_added(whole)[records][0])
            found.append(since.value)
            covariance.append(since.covariance)
    return HeldOut(np.array(true), np.array(found), np.array(covariance)), len(held) - len(true)


def _calibrated(held: frozenset[str], used: frozenset[str] | None) -> Machine:
    """Return the kit calibrated without some conditions, or with some alone."""
    machine, whole, conditions = kit()
    condition = np.array(conditions)
    taught = ~np.isin(condition, list(held)) if used is None else np.isin(condition, list(used))
    run = CalibrationRun("taught", whole.pick(taught), tuple(condition[taught].tolist()), steady=True)
    return calibrate(machine, [run]).machine


def by_least_squares(held: frozenset[str], *, used: frozenset[str] | None = None) -> HeldOut:
    """Estimate the same by least squares with a free offset and a weight per probe and speed."""
    _, whole, conditions = kit()
    condition, added = np.array(conditions), _added(whole)
    taught = ~np.isin(condition, list(held)) if used is None else np.isin(condition, list(used))
    fast = whole.speed > BETWEEN_SPEEDS
    places, found = np.flatnonzero(np.isin(condition, list(held))), []
    for place in places:
        rows = taught & (fast == fast[place])
        given = np.column_stack([np.ones(rows.sum()), added[rows]])
        influence = np.linalg.lstsq(given, whole.phasor[rows], rcond=None)[0]
        rest = np.sum(np.abs(whole.phasor[rows] - given @ influence) ** 2, axis=0)
        # As many records as unknowns leave nothing to weigh by.
        size = np.sqrt(rest) if rows.sum() > given.shape[1] + 1 else np.ones(rest.size)
        answer = np.linalg.lstsq(influence[1:].T / size[:, None], (whole.phasor[place] - influence[0]) / size, rcond=None)[0]
        found.append(answer)
    return HeldOut(added[places], np.array(found))


def gathered(parts: Sequence[HeldOut]) -> HeldOut:
    """Return the records of several folds as one."""
    covariances = [one.covariance for one in parts if one.covariance is not None]
    return HeldOut(
        np.concatenate([one.true for one in parts]),
        np.concatenate([one.found for one in parts]),
        np.concatenate(covariances) if covariances else None,
    )


def _added(measurement: Measurement) -> Complexes:
    if measurement.added is None:
        raise RuntimeError("the records state no unbalance")
    return measurement.added
