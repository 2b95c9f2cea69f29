"""The 2× against the 1× near running speed: misalignment and cracks raise the 2×, an unbalance does not.

Per sample the ratio of the two amplitudes as they were measured; of these the median, whose interval lies between two of them
and supposes no distribution (order statistics of a binomial; Conover, Practical Nonparametric Statistics, Wiley 1999, §3.2).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.special

from estimator.arrays import Complexes, Floats

NEAR = 0.1
"""Samples within this part of the running speed count."""
TAIL = 0.025
"""Probability that the median lies beyond either end of the interval."""
FEWEST = 6
"""Fewer samples have no two between which their median lies with 95 %."""


@dataclass(frozen=True)
class Orders:
    """1× and 2× of S samples of m channels. speed: (S,) [rad/s]. first, second: (S, m) phasors [m], NaN where not usable."""

    speed: Floats
    first: Complexes
    second: Complexes


@dataclass(frozen=True)
class OrderRatio:
    """Median of |2×|/|1×| [-] with its 95 % interval, and how many samples it is of."""

    value: float
    lower: float
    upper: float
    samples: int


def measures_second(runs: Sequence[Orders], channel: int) -> bool:
    """Whether a channel has a 2× anywhere in some runs."""
    return any(bool(np.any(np.isfinite(run.second[:, channel]))) for run in runs)


def second_over_first(runs: Sequence[Orders], channel: int, *, running_speed: float) -> OrderRatio | None:
    """Of one channel in all samples near a speed [rad/s] together; None where there are fewer than FEWEST."""
    found = np.sort(np.concatenate([np.empty(0), *(_ratios(run, channel, running_speed) for run in runs)]))
    if found.size < FEWEST:
        return None
    first = int(np.searchsorted(scipy.special.bdtr(np.arange(found.size + 1.0), found.size, 0.5), TAIL)) - 1
    return OrderRatio(float(np.median(found)), float(found[first]), float(found[found.size - 1 - first]), found.size)


def _ratios(run: Orders, channel: int, running_speed: float) -> Floats:
    near = np.abs(run.speed - running_speed) <= NEAR * running_speed
    first, second = np.abs(run.first[near, channel]), np.abs(run.second[near, channel])
    known = np.isfinite(second) & (first > 0.0)  # NaN is not above zero
    return np.asarray(second[known] / first[known])
