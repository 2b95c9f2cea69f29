"""Vectors of a run at running speed: of each order the mean of the phasors near it, as they are trended from run to run.

Derived here. A mean of phasors, not of amplitudes, since scatter of the phase would leave the latter too large. Of overall
levels and gaps, which have no phase, the plain mean.
"""

from dataclasses import dataclass

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.phasors.harmonic_ratio import Orders
from estimator.phasors.near_speed import near_running_speed


@dataclass(frozen=True)
class RunningSpeedVectors:
    """Vectors of one run at running speed, of m channels.

    Attributes:
        speed: Mean speed of the samples [rad/s].
        samples: Number of samples.
        first: Vectors (m,) of the 1× [m]; NaN where no sample has one.
        second: Vectors (m,) of the 2× [m]; NaN where no sample has one.
    """

    speed: float
    samples: int
    first: Complexes
    second: Complexes


def running_speed_vectors(run: Orders, *, running_speed: float) -> RunningSpeedVectors | None:
    """Compute the mean vectors of a run's samples within NEAR of a speed.

    Args:
        run: Samples of the run.
        running_speed: The speed [rad/s].

    Returns:
        Vectors of each channel [m]; None where no sample is near.
    """
    near = near_running_speed(run.speed, running_speed)
    count = int(np.count_nonzero(near))
    if count == 0:
        return None
    return RunningSpeedVectors(float(np.mean(run.speed[near])), count, _mean(run.first[near]), _mean(run.second[near]))


def mean_level(levels: Floats) -> Floats:
    """Compute the mean of levels without phase, such as gaps.

    Args:
        levels: Levels (S, m) [m], NaN where there is none.

    Returns:
        Mean levels (m,) [m]; NaN where no sample has one.
    """
    known = np.isfinite(levels)
    count = np.count_nonzero(known, axis=0)
    return np.where(count > 0, np.sum(np.where(known, levels, 0.0), axis=0) / np.maximum(count, 1), np.nan)


def _mean(phasor: Complexes) -> Complexes:
    known = np.isfinite(phasor)
    count = np.count_nonzero(known, axis=0)
    total = np.sum(np.where(known, phasor, 0.0), axis=0)
    return np.where(count > 0, total / np.maximum(count, 1), complex(np.nan, np.nan))


def speed_of_trend(highest: Floats) -> float:
    """Return the speed at which runs are compared where the document names none: the lowest of their highest speeds.

    Args:
        highest: Highest speeds (n,) of the runs [rad/s]; at least one.

    Returns:
        The speed [rad/s]: all of the runs came to it.

    Raises:
        ValueError: There is no run.
    """
    return float(np.min(highest))
