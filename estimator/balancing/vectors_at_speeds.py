"""Vectors of runs at common speeds: means of dwells, and straight lines through a sweep's samples near each speed.

Derived here: over a narrow window of speed the phasor is a straight line, whose value at the window's speed and whose
scatter are those of linear regression.
"""

from collections.abc import Sequence

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.errors import Invalid
from estimator.machine.rules import Noise
from estimator.phasors.measurement import Measurement
from estimator.phasors.noise import error_size

WINDOW = 0.01
"""Half width of the window of speeds that count as one speed, as a part of it [-]."""
FEWEST = 5
"""Number of samples in a window from which their own scatter says how well their mean is known."""


class NoCommonSpeed(Invalid):
    """Raised when runs have no speed in common within the document's range."""


def common_speeds(runs: Sequence[Measurement], *, lowest: float, highest: float, most: int = 10) -> Floats:
    """Choose speeds of the first run at which others have samples, too.

    Dwells give their mean speed, sweeps speeds two windows apart. Of more than are wanted, those are taken at which channels
    respond most, and others as far from those and from each other as can be: samples taken evenly in time lie thick where
    the machine is slow, and would leave out the resonance.

    Source: Gonzalez, Theor. Comput. Sci. 38 (1985) 293, doi:10.1016/0304-3975(85)90224-5, for speeds far from each other.

    Args:
        runs: The runs, the initial one first.
        lowest: Lowest speed allowed [rad/s].
        highest: Highest speed allowed [rad/s].
        most: Largest number of speeds.

    Returns:
        Speeds (S,), ascending [rad/s].

    Raises:
        NoCommonSpeed: There is none.
    """
    first = np.sort(runs[0].speed)
    within = first[(first >= lowest * (1 - WINDOW)) & (first <= highest * (1 + WINDOW))]
    found: list[float] = []
    for cluster in _clusters(within):
        low, high = max(float(cluster[0]), lowest), min(float(cluster[-1]), highest)
        if high <= low * (1 + 2 * WINDOW):
            found.append(min(max(float(np.mean(cluster)), lowest), highest))
        else:
            count = int(1 + np.log(high / low) / np.log1p(2 * WINDOW))
            found += np.geomspace(low, high, max(2, count)).tolist()
    seen = {one: sum(bool(np.any(np.abs(run.speed - one) <= WINDOW * one)) for run in runs) for one in found}
    shared = [one for one in found if seen[one] > 1]
    if not shared:
        raise NoCommonSpeed(
            f"the runs have no speed in common between {lowest * 30 / np.pi:.0f} and {highest * 30 / np.pi:.0f} r/min, "
            f"within {100 * WINDOW:g} %: take the trial runs at the speeds of the initial run"
        )
    return _picked(np.array(shared), runs[0], most)


def _picked(speed: Floats, run: Measurement, most: int) -> Floats:
    """Return at most so many of some ascending speeds: those of the greatest response, and others far from each other."""
    if speed.size <= most:
        return speed
    kept = _of_greatest_response(speed, run)[: most // 2]
    kept += [end for end in (speed.size - 1, 0) if end not in kept]
    while len(kept) < most:
        away = np.min(np.abs(speed[:, None] - speed[kept]), axis=1)
        kept.append(int(np.argmax(away)))
    return np.asarray(speed[np.sort(kept[:most])])


def _of_greatest_response(speed: Floats, run: Measurement) -> list[int]:
    """Return the numbers of the speeds at which a channel shows most, the channel that shows most first."""
    amplitude = np.where(run.usable, np.abs(run.phasor), 0.0)
    seen = np.array(
        [np.max(amplitude[np.abs(run.speed - one) <= WINDOW * one], axis=0, initial=0.0) for one in speed.tolist()]
    )
    channels = np.argsort(-np.max(seen, axis=0))
    return list(dict.fromkeys(int(np.argmax(seen[:, channel])) for channel in channels if np.max(seen[:, channel]) > 0.0))


def vectors_at(run: Measurement, speed: Floats, *, noise: Noise) -> tuple[Complexes, Floats]:
    """Compute the vectors of a run at some speeds.

    Source: own derivation: a straight line over a narrow window of speed, in the module's docstring.

    Args:
        run: The run.
        speed: Speeds (S,) [rad/s].
        noise: Expected error of one phasor, where a window holds too few samples to show it.

    Returns:
        Vectors (S, m), NaN where the run shows none [m], and the rms of their complex errors (S, m) [m].
    """
    channels = run.phasor.shape[1]
    vector = np.full((speed.size, channels), complex(np.nan, np.nan))
    error = np.full((speed.size, channels), np.nan)
    expected = error_size(noise, np.abs(run.phasor), run.scatter)
    for row, one in enumerate(speed.tolist()):
        near = np.abs(run.speed - one) <= WINDOW * one
        for channel in range(channels):
            used = near & run.usable[:, channel]
            if used.any():
                vector[row, channel], scatter = _at(run.speed[used] / one - 1.0, run.phasor[used, channel])
                size = float(np.sqrt(np.mean(expected[used, channel] ** 2))) if np.isnan(scatter) else scatter
                error[row, channel] = max(size, noise.floor) / np.sqrt(np.count_nonzero(used))
    return vector, error


def _at(offset: Floats, phasor: Complexes) -> tuple[complex, float]:
    """Compute the value at no offset, and the rms scatter of one sample about the line; NaN for too few samples."""
    columns = [np.ones_like(offset)]
    # A line needs samples on both sides; samples of a dwell all lie on one spot, which may be a little beside the speed.
    if offset.size >= FEWEST and offset.min() < 0.0 < offset.max() and np.ptp(offset) > WINDOW / 2:
        columns.append(offset)
    design = np.stack(columns, axis=1).astype(complex)
    solution = np.linalg.lstsq(design, phasor, rcond=None)[0]
    left = phasor - design @ solution
    freedom = offset.size - len(columns)
    scatter = float(np.sqrt(np.sum(np.abs(left) ** 2) / freedom)) if offset.size >= FEWEST else float("nan")
    return complex(solution[0]), scatter


def _clusters(ascending: Floats) -> list[Floats]:
    """Separate ascending speeds where the gap between neighbours is wider than a window."""
    if ascending.size == 0:
        return []
    gaps = np.flatnonzero(np.diff(ascending) > WINDOW * ascending[:-1]) + 1
    return list(np.split(ascending, gaps))
