"""Control charts on standardised deviations, mean 0 and variance 1 while nothing has changed: CUSUM for steps, EWMA for creep.

CUSUM: Page (1954, doi:10.1093/biomet/41.1-2.100). Its limits come from its run length, computed as a Markov chain (Brook and
Evans 1972, doi:10.1093/biomet/59.3.539), so that a chart has a stated rate of false alarms. EWMA: Roberts (1959,
doi:10.1080/00401706.1959.10489860), run length in the same way (Lucas and Saccucci 1990, doi:10.1080/00401706.1990.10484583).
"""

import math
from collections.abc import Callable
from functools import cache

import numpy as np
import scipy.optimize
import scipy.special

from estimator.condensation import Floats

STATES = 101
"""Steps of the Markov chain: run lengths are right to a per cent or so."""
LARGEST_LIMIT = 30.0


def cusum(deviation: Floats, *, reference: float) -> Floats:
    """Upper CUSUM (n,) of deviations (n,): it grows by what exceeds the reference, and never falls below 0.

    The reference is half of the step that is to be found soonest, in standard deviations.
    """
    grown = np.empty(deviation.size)
    level = 0.0
    for index, value in enumerate(deviation.tolist()):
        level = max(0.0, level + value - reference)
        grown[index] = level
    return grown


def change_began(deviation: Floats, *, reference: float) -> int | None:
    """Index of the first value behind the last zero of the upper CUSUM: where the change is likeliest to have begun."""
    grown = cusum(deviation, reference=reference)
    if not grown.size or grown[-1] == 0.0:
        return None
    zeros = np.flatnonzero(grown == 0.0)
    return int(zeros[-1]) + 1 if zeros.size else 0


def cusum_run_length(*, reference: float, limit: float, shift: float = 0.0) -> float:
    """Values until the upper CUSUM exceeds the limit, on average, when all deviations are shifted by so many σ."""
    width = 2.0 * limit / (2 * STATES - 1)
    middle = width * np.arange(STATES)
    # From the middle of one state into another: the lowest collects everything down to minus infinity.
    upper = middle[None, :] + width / 2.0 - middle[:, None] + reference - shift
    within = scipy.special.ndtr(upper)
    move = np.diff(within, axis=1, prepend=0.0)
    return float(np.linalg.solve(np.eye(STATES) - move, np.ones(STATES))[0])


def ewma(deviation: Floats, *, weight: float) -> Floats:
    """Exponentially weighted mean (n,) of deviations (n,), each divided by its own standard deviation."""
    if not 0.0 < weight <= 1.0:
        raise ValueError(f"weight is {weight}: it must lie between 0 and 1")
    found = np.empty(deviation.size)
    mean, left = 0.0, 1.0
    for index, value in enumerate(deviation.tolist()):
        mean += weight * (value - mean)
        left *= (1.0 - weight) ** 2
        found[index] = mean / math.sqrt(weight / (2.0 - weight) * (1.0 - left))
    return found


def ewma_run_length(*, weight: float, limit: float, shift: float = 0.0) -> float:
    """Values until the two-sided EWMA leaves ±limit, its long-run standard deviations, on average."""
    edge = limit * math.sqrt(weight / (2.0 - weight))
    width = 2.0 * edge / STATES
    middle = -edge + width * (np.arange(STATES) + 0.5)
    bounds = np.concatenate([middle - width / 2.0, [edge]])
    within = scipy.special.ndtr((bounds[None, :] - (1.0 - weight) * middle[:, None]) / weight - shift)
    move = np.diff(within, axis=1)
    return float(np.linalg.solve(np.eye(STATES) - move, np.ones(STATES))[STATES // 2])


@cache
def cusum_limit(*, reference: float, run_length: float) -> float:
    """The limit with which a false alarm comes once in so many values on average. Raises ValueError below 2."""
    if run_length < 2.0:
        raise ValueError(f"run_length is {run_length}: it must be at least 2")

    def off(limit: float) -> float:
        return math.log(cusum_run_length(reference=reference, limit=limit) / run_length)

    return float(scipy.optimize.brentq(off, 1e-3, _large_enough(off), xtol=1e-6))


@cache
def ewma_limit(*, weight: float, run_length: float) -> float:
    """The same for the two-sided EWMA."""
    if run_length < 2.0:
        raise ValueError(f"run_length is {run_length}: it must be at least 2")

    def off(limit: float) -> float:
        return math.log(ewma_run_length(weight=weight, limit=limit) / run_length)

    return float(scipy.optimize.brentq(off, 1e-3, _large_enough(off), xtol=1e-6))


def _large_enough(off: Callable[[float], float]) -> float:
    limit = 1.0
    while limit < LARGEST_LIMIT and off(limit) < 0.0:
        limit *= 1.5
    return limit
