"""Control charts on standardised deviations, mean 0 and variance 1 while nothing has changed: CUSUM for steps, EWMA for creep.

CUSUM: Page (1954, doi:10.1093/biomet/41.1-2.100). Its limits come from its run length, so that a chart has a stated rate of
false alarms: Page's integral equation by Gauss-Legendre quadrature (Goel and Wu 1971, doi:10.1080/00401706.1971.10488779).
EWMA: Roberts (1959, doi:10.1080/00401706.1959.10489860), run length in the same way (Crowder 1987,
doi:10.1080/00401706.1987.10488267).
"""

import math
from functools import cache

import numpy as np
import scipy.special

from estimator.arrays import Floats

NODES_PER_WIDTH, NODE_STEP, MAXIMUM_NODES = 2.0, 24, 360
"""Nodes of the quadrature per standard deviation of one value's effect on the chart, the step in which nodes are added, and
their largest number; five digits hold.
"""


def cusum(deviation: Floats, *, reference: float) -> Floats:
    """Compute the upper CUSUM (Page 1954): it grows by the excess over the reference, and never falls below 0.

    Args:
        deviation: Standardised deviations (n,) [-].
        reference: Half of the step that is to be found soonest, in standard deviations [-].

    Returns:
        Level of the chart (n,) [-].
    """
    grown = np.empty(deviation.size)
    level = 0.0
    for index, value in enumerate(deviation.tolist()):
        level = max(0.0, level + value - reference)
        grown[index] = level
    return grown


def change_began(deviation: Floats, *, reference: float) -> int | None:
    """Find the likeliest beginning of a change: the first value behind the last zero of the upper CUSUM.

    Args:
        deviation: Standardised deviations (n,) [-].
        reference: Reference of the CUSUM, in standard deviations [-].

    Returns:
        Index of that value; None where the chart stands at 0 at its end.
    """
    grown = cusum(deviation, reference=reference)
    if not grown.size or grown[-1] == 0.0:
        return None
    zeros = np.flatnonzero(grown == 0.0)
    return int(zeros[-1]) + 1 if zeros.size else 0


def cusum_run_length(*, reference: float, limit: float, shift: float = 0.0) -> float:
    """Compute the average number of values until the upper CUSUM exceeds the limit (Page 1954; Goel and Wu 1971).

    Source: Page (1954, doi:10.1093/biomet/41.1-2.100) and Goel and Wu (1971, doi:10.1080/00401706.1971.10488779).

    Args:
        reference: Reference of the CUSUM, in standard deviations [-].
        limit: Limit of the chart [-].
        shift: Shift of all deviations, in standard deviations [-].

    Returns:
        Average run length [-].
    """
    place, weight = _quadrature(0.0, limit, width=1.0)
    # From 0, where all that is below collects, and from each node to each other.
    start = np.concatenate([[0.0], place])
    to_zero = scipy.special.ndtr(reference - shift - start)
    onward = weight * _density(place[None, :] + reference - shift - start[:, None])
    move = np.concatenate([to_zero[:, None], onward], axis=1)
    return float(np.linalg.solve(np.eye(start.size) - move, np.ones(start.size))[0])


def ewma(deviation: Floats, *, weight: float) -> Floats:
    """Compute the exponentially weighted mean (Roberts 1959), each value divided by its own standard deviation.

    Args:
        deviation: Standardised deviations (n,) [-].
        weight: Weight of the newest deviation, above 0, at most 1 [-].

    Returns:
        Standardised mean (n,) [-].

    Raises:
        ValueError: The weight is not above 0 and at most 1.
    """
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
    """Compute the average number of values until the two-sided EWMA leaves ±limit (Crowder 1987).

    Source: Roberts (1959, doi:10.1080/00401706.1959.10489860) and Crowder (1987, doi:10.1080/00401706.1987.10488267).

    Args:
        weight: Weight of the newest deviation [-].
        limit: Limit in long-run standard deviations of the mean [-].
        shift: Shift of all deviations, in standard deviations [-].

    Returns:
        Average run length [-].
    """
    edge = limit * math.sqrt(weight / (2.0 - weight))
    place, share = _quadrature(-edge, edge, width=weight)
    start = np.concatenate([[0.0], place])
    onward = share / weight * _density((place[None, :] - (1.0 - weight) * start[:, None]) / weight - shift)
    length = np.linalg.solve(np.eye(place.size) - onward[1:], np.ones(place.size))
    return float(1.0 + onward[0] @ length)


def _quadrature(begin: float, end: float, *, width: float) -> tuple[Floats, Floats]:
    """Return nodes and weights (n,) of the Gauss-Legendre rule, enough for densities of a width."""
    count = NODE_STEP * math.ceil(NODES_PER_WIDTH * (end - begin) / width / NODE_STEP)
    place, weight = _rule(min(count, MAXIMUM_NODES))
    half = (end - begin) / 2.0
    return begin + half * (place + 1.0), half * weight


@cache
def _rule(count: int) -> tuple[Floats, Floats]:
    place, weight = np.polynomial.legendre.leggauss(count)
    return place, weight


def _density(value: Floats) -> Floats:
    """Compute the density of the standard normal distribution."""
    return np.asarray(np.exp(-0.5 * value**2) / math.sqrt(2.0 * math.pi))
