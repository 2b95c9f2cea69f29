"""Ratio of the 2× to the 1× near running speed: misalignment and cracks raise the 2×, an unbalance does not.

Per sample the ratio of the two amplitudes as they were measured; of these the median, whose interval lies between two of them
and supposes no distribution (order statistics of a binomial; Conover, Practical Nonparametric Statistics, Wiley 1999, §3.2).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.special

from estimator.arrays import Complexes, Floats

NEAR = 0.1
"""Part of the running speed within which samples count [-]."""
TAIL = 0.025
"""Probability that the median lies beyond either end of the interval [-]."""
FEWEST = 6
"""Least number of samples: fewer have no two between which their median lies with 95 %."""


@dataclass(frozen=True)
class Orders:
    """Orders 1× and 2× of S samples of m channels.

    Attributes:
        speed: Speeds (S,) [rad/s].
        first: Phasors (S, m) of the 1× [m]; NaN where not usable.
        second: Phasors (S, m) of the 2× [m]; NaN where not usable.
    """

    speed: Floats
    first: Complexes
    second: Complexes


@dataclass(frozen=True)
class OrderRatio:
    """Median of |2×|/|1×| with its interval.

    Attributes:
        value: Median [-].
        lower: Lower end of the 95 % interval [-].
        upper: Upper end of the 95 % interval [-].
        samples: Number of samples.
    """

    value: float
    lower: float
    upper: float
    samples: int


def measures_second(runs: Sequence[Orders], channel: int) -> bool:
    """Check whether a channel has a 2× anywhere in some runs.

    Args:
        runs: The runs.
        channel: Index of the channel.

    Returns:
        Whether it has.
    """
    return any(bool(np.any(np.isfinite(run.second[:, channel]))) for run in runs)


def second_over_first(runs: Sequence[Orders], channel: int, *, running_speed: float) -> OrderRatio | None:
    """Compute the ratio |2×|/|1×| of one channel in all samples near a speed together (Conover 1999, §3.2).

    Source: Conover, Practical Nonparametric Statistics, Wiley 1999, §3.2.

    Args:
        runs: The runs.
        channel: Index of the channel.
        running_speed: The speed [rad/s].

    Returns:
        Ratio [-] with its interval; None where there are fewer than FEWEST samples.
    """
    found = np.sort(np.concatenate([np.empty(0), *(_ratios(run, channel, running_speed) for run in runs)]))
    if found.size < FEWEST:
        return None
    first = int(np.searchsorted(scipy.special.bdtr(np.arange(found.size + 1.0), found.size, 0.5), TAIL)) - 1
    return OrderRatio(float(np.median(found)), float(found[first]), float(found[found.size - 1 - first]), found.size)


@dataclass(frozen=True)
class SecondOrder:
    """The 2× of a channel near a speed, from the mean of its phasors.

    Attributes:
        amplitude: Amplitude, 0-to-peak [m].
        amplitude_error: Its standard error [m].
        phase: Phase lead of the 2×, of a turn of it, between -π and π [rad].
        phase_error: Its standard error [rad].
    """

    amplitude: float
    amplitude_error: float
    phase: float
    phase_error: float


def second_order(runs: Sequence[Orders], channel: int, *, running_speed: float) -> SecondOrder | None:
    """Compute amplitude and phase of the 2× of one channel in all samples near a speed together (JCGM 100:2008, 4.2 and 5.2).

    Args:
        runs: The runs.
        channel: Index of the channel.
        running_speed: The speed [rad/s].

    Returns:
        Amplitude and phase; None where there are fewer than FEWEST samples, or nothing but zeros.
    """
    near = [run.second[np.abs(run.speed - running_speed) <= NEAR * running_speed, channel] for run in runs]
    whole = np.concatenate([np.empty(0, complex), *near])
    whole = whole[np.isfinite(whole)]
    mean = complex(whole.mean()) if whole.size >= FEWEST else 0j
    if mean == 0j:
        return None
    along = (whole - mean) * np.conj(mean) / abs(mean)
    radial, across = (float(np.std(part, ddof=1)) / math.sqrt(whole.size) for part in (along.real, along.imag))
    return SecondOrder(abs(mean), radial, float(np.angle(mean)), across / abs(mean))


def _ratios(run: Orders, channel: int, running_speed: float) -> Floats:
    near = np.abs(run.speed - running_speed) <= NEAR * running_speed
    first, second = np.abs(run.first[near, channel]), np.abs(run.second[near, channel])
    known = np.isfinite(second) & (first > 0.0)  # NaN is not above zero
    return np.asarray(second[known] / first[known])
