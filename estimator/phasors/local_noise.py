"""Noise of a phasor, and whether it is out of line, from the phasors at neighbouring speeds.

Each phasor is compared with the cubic through its two neighbours on either side, in the complex plane over speed. A phasor
that is wrong by Δ leaves a known pattern in the five differences that it takes part in; a resonance, however sharp, leaves
another as long as more than one sample falls on it.
"""

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.phasors.noise import outlier_limit

FEWEST_POINTS = 12
"""Least number of usable points of a channel for its noise to be estimated."""
ALONE = 0.85
"""Least part of the five differences that a single wrong phasor must explain [-]."""
CLEARLY = 2.0
"""Multiple of the largest error that noise would show, from which on a phasor is out of line [-]."""
DENSE = 1.5
"""Largest residual of a straight line over that of a cubic at which samples are dense [-]."""
SAME_SPEED = 1e-5
"""Part of the speed range within which samples are no neighbours in speed [-]."""


class LocalFit(Struct, frozen=True, eq=False):
    """One channel's phasors beside those of their neighbours, n in order of speed.

    Attributes:
        place: Indices of the samples (n,).
        difference: Phasor minus that of the cubic (n,) [m].
        weights: Weights (n, 5) of the phasors at places n-2 to n+2 in the difference, 1 in the middle; rows without two
            neighbours on each side are zero [-].
    """

    place: NDArray[np.intp]
    difference: Complexes
    weights: Floats

    @property
    def error(self) -> Floats:
        """Return the size (n,) of each difference, as large as an error of one phasor would be [m]; NaN at the ends."""
        gain = np.sqrt(np.sum(self.weights**2, axis=1))
        return np.asarray(np.divide(np.abs(self.difference), gain, out=np.full(gain.size, np.nan), where=gain > 0.0))


def local_fit(speed: Floats, phasor: Complexes, usable: NDArray[np.bool_]) -> LocalFit:
    """Fit the cubics through the neighbours of one channel's phasors.

    Args:
        speed: Speeds (S,) [rad/s].
        phasor: Phasors (S,) [m].
        usable: True where a phasor may be used (S,).

    Returns:
        Differences from the cubics [m].
    """
    place = np.flatnonzero(usable)
    place = place[np.argsort(speed[place], kind="stable")]
    if place.size:
        apart = SAME_SPEED * max(float(np.ptp(speed[place])), 1e-300)
        place = place[np.concatenate([[True], np.diff(speed[place]) > apart])]
    values, where = phasor[place], speed[place]
    weights = np.zeros((place.size, 5))
    difference = np.zeros(place.size, dtype=complex)
    if place.size >= 5:
        around = np.stack([where[i : where.size - 4 + i] for i in range(5)], axis=1)
        middle = around[:, 2]
        weights[2:-2, 2] = 1.0
        for i in (0, 1, 3, 4):
            others = [j for j in (0, 1, 3, 4) if j != i]
            weights[2:-2, i] = -np.prod([(middle - around[:, j]) / (around[:, i] - around[:, j]) for j in others], axis=0)
        together = np.stack([values[i : values.size - 4 + i] for i in range(5)], axis=1)
        difference[2:-2] = np.sum(weights[2:-2] * together, axis=1)
    return LocalFit(place, difference, weights)


def neighbour_noise(fit: LocalFit, amplitude: Floats) -> tuple[float, float]:
    """Estimate one channel's noise from medians: robust, and too large where samples are sparse.

    Args:
        fit: The channel's local fit.
        amplitude: Amplitudes (S,) of all samples [m].

    Returns:
        Rms of the relative part [-] and of the floor [m]; NaN where the points are too few.
    """
    error = fit.error
    known = np.isfinite(error)
    if np.count_nonzero(known) < FEWEST_POINTS:
        return float("nan"), float("nan")
    size, square = amplitude[fit.place][known], error[known] ** 2
    middle = np.median(size)
    # The median of a squared circular error is ln 2 of its mean.
    low, high = (float(np.median(square[part]) / np.log(2.0)) for part in (size <= middle, size >= middle))
    small, large = (float(np.median(size[part] ** 2)) for part in (size <= middle, size >= middle))
    relative = max(0.0, (high - low) / (large - small)) if large > 1.5 * small else 0.0
    relative = min(relative, high / large) if large > 0.0 else 0.0
    floor = max(0.0, min(low - relative * small, high - relative * large))
    if relative == 0.0 and large <= 1.5 * small and large > 0.0:
        relative, floor = 1.0, 0.0  # amplitudes that hardly differ cannot tell the two parts apart
    modelled = relative * size**2 + floor
    if not np.all(modelled > 0.0):
        return 0.0, 0.0
    scale = float(np.median(square / modelled)) / np.log(2.0)
    return float(np.sqrt(scale * relative)), float(np.sqrt(scale * floor))


def is_resolved(fit: LocalFit, speed: Floats, phasor: Complexes) -> bool:
    """Check whether one channel's samples are dense enough for the differences to be noise.

    The straight line through the nearest two neighbours then leaves as much as the cubic through four.

    Args:
        fit: The channel's local fit.
        speed: Speeds (S,) [rad/s].
        phasor: Phasors (S,) [m].

    Returns:
        Whether they are.
    """
    if fit.place.size < FEWEST_POINTS:
        return False
    where, values = speed[fit.place], phasor[fit.place]
    part = (where[1:-1] - where[:-2]) / (where[2:] - where[:-2])
    left_over = np.abs(values[1:-1] - (1 - part) * values[:-2] - part * values[2:]) / np.sqrt(1 + (1 - part) ** 2 + part**2)
    return bool(np.median(left_over) < DENSE * np.nanmedian(fit.error))


def isolated_samples(fit: LocalFit, noise: Floats) -> NDArray[np.intp]:
    """Find the samples of one channel that no neighbour agrees with.

    Args:
        fit: The channel's local fit.
        noise: Expected rms error of each sample (S,) [m].

    Returns:
        Indices (k,) of these samples.
    """
    count = fit.place.size
    if count < FEWEST_POINTS:
        return np.empty(0, dtype=np.intp)
    # How each difference i + k holds the phasor i, in units of the errors that noise gives the differences.
    pattern, seen = np.zeros((count, 5)), np.zeros((count, 5), dtype=complex)
    expected = np.sqrt(_spread(fit, noise**2))
    for k in range(-2, 3):
        row = np.arange(count) + k
        inside = (row >= 0) & (row < count)
        at = row[inside]
        known = expected[at] > 0.0
        pattern[inside, k + 2] = np.where(known, fit.weights[at, 2 - k] / np.where(known, expected[at], 1.0), 0.0)
        seen[inside, k + 2] = np.where(known, fit.difference[at] / np.where(known, expected[at], 1.0), 0.0)
    own, whole = np.sum(pattern**2, axis=1), np.sum(np.abs(seen) ** 2, axis=1)
    explained = np.divide(np.abs(np.sum(pattern * seen, axis=1)) ** 2, own, out=np.zeros(count), where=own > 0.0)
    limit = CLEARLY**2 * outlier_limit(np.ones(count, dtype=bool))
    found = (explained > limit) & (explained > ALONE * whole)
    # The first and last samples have no cubic of their own: the few differences that hold them hold a neighbour as well.
    for edge in np.flatnonzero(found & (expected == 0.0)):
        near = found[max(0, edge - 4) : edge + 5]
        found[edge] = explained[edge] >= np.max(explained[max(0, edge - 4) : edge + 5][near])
    return np.asarray(fit.place[found])


def _spread(fit: LocalFit, variance: Floats) -> Floats:
    """Compute the variance of each difference for variances (S,) of the phasors."""
    own = variance[fit.place]
    padded = np.pad(own, 2)
    around = np.stack([padded[i : i + own.size] for i in range(5)], axis=1)
    return np.asarray(np.sum(fit.weights**2 * around, axis=1))
