"""Influence coefficients on the measured RK-4 rotor kit: known unbalances found from conditions that took no part."""

import csv
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.balancing.equivalent_unbalance import equivalent_unbalance
from estimator.balancing.measured_influence import measure_influence
from estimator.balancing.trial_runs import TrialRuns
from estimator.fit.estimates import CONFIDENCE_95

DATA = Path(__file__).resolve().parents[2] / "examples" / "recordings" / "rk4_unbalance_1x.csv"
CHANNELS = ("p1x", "p1y", "p2x", "p2y")
SPEEDS = ("N1", "N2")
FOLDS = 5
MOUNTING_G_MM = 3.0
"""Rms of what the unbalance of a simulated kit differs by from mounting to mounting [g mm]."""
LARGE_G_MM = 24.0
"""Unbalances from which on the phase is judged [g mm]."""


@dataclass(frozen=True)
class HeldOutUnbalances:
    """Errors of unbalances found from conditions that took no part.

    Attributes:
        magnitude: Errors of the magnitudes [g mm].
        phase: Errors of the phases of large unbalances [°].
        standardised: Errors of real and imaginary parts over their standard errors [-].
    """

    magnitude: Floats
    phase: Floats
    standardised: Floats

    @property
    def rms_magnitude(self) -> float:
        """Return the rms error of the magnitudes [g mm]."""
        return float(np.sqrt(np.mean(self.magnitude**2)))

    @property
    def median_phase(self) -> float:
        """Return the median error of the phases of large unbalances [°]."""
        return float(np.median(self.phase))

    @property
    def coverage(self) -> float:
        """Return the part of the 95 % intervals that hold the truth [-]."""
        return float(np.mean(np.abs(self.standardised) <= CONFIDENCE_95))


def kit_runs() -> TrialRuns:
    """Return a run for each condition: vectors of its repeats averaged, in mil; unbalances in g mm.

    The source's vectors are conjugated, and so count with the angles that are engraved.
    """
    with DATA.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    names = list(dict.fromkeys(row["condition"] for row in rows))
    vector = np.full((len(names), len(SPEEDS) * len(CHANNELS)), complex(np.nan, np.nan))
    added = np.zeros((len(names), 2), dtype=complex)
    for number, name in enumerate(names):
        own = [row for row in rows if row["condition"] == name]
        added[number] = [_polar(own[0], "U1"), _polar(own[0], "U2")]
        for place, speed in enumerate(SPEEDS):
            at = [[_parts(row, channel) for channel in CHANNELS] for row in own if row["speed_id"] == speed]
            if at:
                vector[number, place * len(CHANNELS) : (place + 1) * len(CHANNELS)] = np.mean(at, axis=0)
    points = tuple(f"{channel} at {speed}" for speed in SPEEDS for channel in CHANNELS)
    return TrialRuns(tuple(names), ("D1", "D2"), points, vector, added, np.full(vector.shape, np.nan))


def simulated_runs(seed: int, *, noise: float) -> TrialRuns:
    """Return runs as the kit's, simulated with its coefficients: mountings that differ by `MOUNTING_G_MM` in each plane.

    noise: noise of single points, in units of the measured kit's scatter.
    """
    runs, rng = kit_runs(), np.random.default_rng(seed)
    influence = measure_influence(runs)
    moved = runs.added + MOUNTING_G_MM * _scattered(rng, *runs.added.shape)
    vector = influence.offset + moved @ influence.influence.T
    vector += noise * np.sqrt(np.real(np.diag(influence.scatter))) * _scattered(rng, *vector.shape)
    return _shown(runs, vector)


def runs_with_scatter(seed: int) -> TrialRuns:
    """Return runs as the kit's, simulated with its coefficients and the scatter that its own runs have, point by point."""
    runs, rng = kit_runs(), np.random.default_rng(seed)
    influence = measure_influence(runs)
    variance, direction = np.linalg.eigh(influence.scatter)
    size = np.sqrt(np.maximum(variance, 0.0))
    scatter = (size * _scattered(rng, *runs.vector.shape)) @ direction.T
    return _shown(runs, influence.offset + runs.added @ influence.influence.T + scatter)


def _scattered(rng: np.random.Generator, *shape: int) -> Complexes:
    return np.asarray((rng.standard_normal(shape) + 1j * rng.standard_normal(shape)) / np.sqrt(2.0))


def _shown(runs: TrialRuns, vector: Complexes) -> TrialRuns:
    """Return runs with other vectors, where they show any."""
    return replace(runs, vector=np.where(np.isfinite(runs.vector), vector, complex(np.nan, np.nan)))


def held_out(splits: int, runs: TrialRuns | None = None) -> HeldOutUnbalances:
    """Return the errors over some random splits of the conditions into five folds, each left out in turn.

    runs: by default those of the measured kit.
    """
    runs = runs or kit_runs()
    rng = np.random.default_rng(0)
    count = len(runs.names)
    found, truth, size = [], [], []
    for _ in range(splits):
        order = rng.permutation(count)
        for fold in range(FOLDS):
            left_out = order[fold::FOLDS]
            weights, errors = _found(runs, [one for one in range(count) if one not in left_out], left_out.tolist())
            found.append(weights)
            size.append(errors)
            truth.append(runs.added[left_out])
    weight, true, error = np.concatenate(found), np.concatenate(truth), np.concatenate(size)
    large = np.abs(true) >= LARGE_G_MM
    turned = np.degrees(np.angle(weight[large] / true[large]))
    parts = np.stack([(weight - true).real, (weight - true).imag]) / error
    return HeldOutUnbalances(np.abs(weight) - np.abs(true), np.abs(turned), parts.reshape(-1))


def _found(runs: TrialRuns, kept: Sequence[int], left_out: Sequence[int]) -> tuple[Complexes, Floats]:
    """Return the unbalances of conditions that are left out, and their widened standard errors along any direction."""
    influence = measure_influence(runs.pick(kept))
    both = [equivalent_unbalance(influence, runs.vector[one], beside_offset=True) for one in left_out]
    errors = [influence.widening * np.sqrt(np.real(np.diag(covariance)) / 2.0) for _, covariance in both]
    return np.array([weight for weight, _ in both]), np.array(errors)


def _parts(row: dict[str, str], channel: str) -> complex:
    return complex(float(row[f"{channel}_raw_re_mil"]), float(row[f"{channel}_raw_im_mil"]))


def _polar(row: dict[str, str], disc: str) -> complex:
    return complex(float(row[f"{disc}_gmm"]) * np.exp(1j * np.radians(float(row[f"{disc}_deg"]))))
