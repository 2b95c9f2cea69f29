"""Control charts on standardised deviations, mean 0 and variance 1 while nothing has changed: CUSUM for steps, EWMA for creep.

CUSUM: Page (1954, doi:10.1093/biomet/41.1-2.100). Its limits come from its run length, so that a chart has a stated rate of
false alarms: Page's integral equation by Gauss-Legendre quadrature (Goel and Wu 1971, doi:10.1080/00401706.1971.10488779).
EWMA: Roberts (1959, doi:10.1080/00401706.1959.10489860), run length in the same way (Crowder 1987,
doi:10.1080/00401706.1987.10488267).
"""

import math
from collections.abc import Callable
from functools import cache

import numpy as np
import scipy.optimize
import scipy.special

from estimator.arrays import Floats

NODES_PER_WIDTH, NODE_STEP, MOST_NODES = 2.0, 24, 360
"""Nodes of the quadrature per standard deviation of what one value moves the chart by, in such steps: five digits hold."""
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
    place, weight = _quadrature(0.0, limit, width=1.0)
    # From 0, where all that is below collects, and from each node to each other.
    start = np.concatenate([[0.0], place])
    to_zero = scipy.special.ndtr(reference - shift - start)
    onward = weight * _density(place[None, :] + reference - shift - start[:, None])
    move = np.concatenate([to_zero[:, None], onward], axis=1)
    return float(np.linalg.solve(np.eye(start.size) - move, np.ones(start.size))[0])


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
    place, share = _quadrature(-edge, edge, width=weight)
    start = np.concatenate([[0.0], place])
    onward = share / weight * _density((place[None, :] - (1.0 - weight) * start[:, None]) / weight - shift)
    length = np.linalg.solve(np.eye(place.size) - onward[1:], np.ones(place.size))
    return float(1.0 + onward[0] @ length)


def _quadrature(begin: float, end: float, *, width: float) -> tuple[Floats, Floats]:
    """Nodes and weights (n,) of the Gauss-Legendre rule, enough for densities of a width."""
    count = NODE_STEP * math.ceil(NODES_PER_WIDTH * (end - begin) / width / NODE_STEP)
    place, weight = _rule(min(count, MOST_NODES))
    half = (end - begin) / 2.0
    return begin + half * (place + 1.0), half * weight


@cache
def _rule(count: int) -> tuple[Floats, Floats]:
    place, weight = np.polynomial.legendre.leggauss(count)
    return place, weight


def _density(value: Floats) -> Floats:
    """Of the standard normal distribution."""
    return np.asarray(np.exp(-0.5 * value**2) / math.sqrt(2.0 * math.pi))


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
