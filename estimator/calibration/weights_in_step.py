"""Differences between mountings that go with the trial weights: then weights, angles or senses were stated wrongly.

Discs that are mounted anew differ by chance, and their differences know nothing of the weights that are put on. A weight that
is stated in the wrong sense, on the wrong disc or for the wrong run leaves a difference that goes with it. So each disc's
differences are regressed on the two parts of its own weight; what these explain and what they leave follow an F distribution
if nothing is wrong (Scheffé, The Analysis of Variance, 1959, sec. 2.5). Nor is one difference far larger than all others
(Cochran, Ann. Eugen. 11 (1941) 47, doi:10.1111/j.1469-1809.1941.tb02271.x).

Weights that do hardly more than the differences leave the gains open: one complex factor on all of them is told by the
weights alone, and follows F with two degrees of freedom. All count the mountings there are, so that with few of them right
weights are refused as seldom as with many. What few mountings, or a slip that leaves most weights right, show too weakly for
that is seen by trying the slips: angles counted the other way round, two discs or two runs exchanged, one run's weights
opposite, some weights in another unit. Of H others one is likelier than a right statement by the factor H/α in less than the
part α of cases (Royall, J. Am. Stat. Assoc. 95 (2000) 760, doi:10.1080/01621459.2000.10474264).
"""

from collections.abc import Iterator
from itertools import combinations, permutations

import numpy as np
import scipy.special

from estimator.arrays import Complexes, Floats
from estimator.calibration.mounted_problem import MountedProblem
from estimator.units import KILOGRAM_METRES

SEEN = 1e-6
"""Part of the largest singular value from which on a part of a weight varies at all [-]."""
SMALLEST_CHANCE = 1e-3
"""Chance of differences that go so well with the weights, beneath which something is stated wrongly [-]."""
UNIT_RATIOS = sorted(one / other for one, other in permutations(KILOGRAM_METRES.values(), 2) if one > other)
"""Factors by which an unbalance is wrong in another unit [-]."""
IN_STEP = "and go with these"
ONE_MORE = "one disc of one mounting by far more than the others"
NOT_SEEN = "which chance would do as well without any"
TOO_FEW = "and there are too few mountings to tell them from these"


def judge_weights(problem: MountedProblem, theta: Floats, *, part: float) -> str:
    """Judge whether chance explains large differences between mountings (Scheffé 1959, sec. 2.5).

    Args:
        problem: The problem of the calibration.
        theta: Its fit's end θ (n,) [-].
        part: Rms of what the differences do over that of what the trial weights do [-].

    Returns:
        What speaks against the weights as they are stated, in words; empty where chance explains the differences.
    """
    weight = problem.weight(np.abs(problem.measurement.phasor), 0.0)
    parts = problem.linearisation(theta, weight).difference[:, : 2 * problem.planes]
    added = problem.measurement.added
    if added is None:
        return ""
    # In units of what each disc usually differs by, so that all discs count alike.
    weights = np.array([added[problem.mounting == one].mean(axis=0) for one in range(len(parts))])
    difference: Complexes = np.asarray(parts[:, ::2] + 1j * parts[:, 1::2])
    return judge_differences(difference, np.asarray(weights / problem.spread[: problem.planes], dtype=complex), part=part)


def judge_differences(difference: Complexes, weight: Complexes, *, part: float) -> str:
    """Judge whether chance explains differences between mountings (Scheffé 1959, sec. 2.5).

    Source: Scheffé, The Analysis of Variance, Wiley 1959, sec. 2.5, and Cochran, Ann. Eugen. 11 (1941) 47,
    doi:10.1111/j.1469-1809.1941.tb02271.x.

    Args:
        difference: Differences (M, P) of M mountings and P discs, which scatter alike [-].
        weight: Weights (M, P) [-].
        part: Rms of what the differences do over that of what the weights do [-].

    Returns:
        What speaks against the weights as they are stated, in words; empty where chance explains the differences.
    """
    explained = left = 0.0
    tried = free = 0
    least = SEEN * max(float(np.abs(weight).max()), 1e-300)
    for own, put in zip(difference.T, weight.T, strict=True):
        centred = own - own.mean()
        columns = np.stack([put.real, put.imag], axis=1)
        directions, size, _ = np.linalg.svd(columns - columns.mean(axis=0), full_matrices=False)
        seen = directions[:, size > least]
        shown = float(np.sum(np.abs(seen.T @ centred) ** 2))
        explained += shown
        left += float(np.sum(np.abs(centred) ** 2)) - shown
        tried += seen.shape[1]
        free += own.size - 1 - seen.shape[1]
    if free <= 0 or tried == 0:
        return TOO_FEW
    if _chance(explained / max(left, 1e-300), tried, free) < SMALLEST_CHANCE:
        return IN_STEP
    if _other_statement_is_likelier(difference, weight):
        return IN_STEP
    if _chance_of_largest(difference) < SMALLEST_CHANCE:
        return ONE_MORE
    beside_factor = (difference.shape[0] - 1) * difference.shape[1] - 1
    return "" if _chance(part**-2, 1, beside_factor) < SMALLEST_CHANCE else NOT_SEEN


def _other_statement_is_likelier(difference: Complexes, weight: Complexes) -> bool:
    """Return whether weights as a usual slip would have them are likelier than as they are stated, beyond chance."""
    independent = (difference.shape[0] - 1) * difference.shape[1] - 1
    others = list(_slips(weight))
    shown = weight + difference
    least = min((_left_by(shown, other) for other in others), default=np.inf)
    likelier = independent * np.log(max(_left_by(shown, weight), 1e-300) / max(least, 1e-300))
    return bool(likelier > np.log(len(others) / SMALLEST_CHANCE))


def _slips(weight: Complexes) -> Iterator[Complexes]:
    """Yield the weights (M, P) as they would be, had one of the usual slips been made in stating them."""
    mountings, discs = weight.shape
    yield weight.conj()
    for pair in combinations(range(discs), 2):
        yield weight[:, _exchanged(discs, pair)]
    for pair in combinations(range(mountings), 2):
        yield weight[_exchanged(mountings, pair)]
    for one in np.flatnonzero(weight.any(axis=1)):
        yield np.where(np.arange(mountings)[:, None] == one, -weight, weight)
    size = np.abs(weight).max(axis=1, keepdims=True)
    usual = float(np.median(size[size > 0.0])) if size.any() else 0.0
    for ratio in UNIT_RATIOS:
        heavy = size > np.sqrt(ratio) * usual
        if heavy.any():
            yield np.where(heavy, weight / ratio, weight)


def _exchanged(count: int, pair: tuple[int, int]) -> list[int]:
    order = list(range(count))
    order[pair[0]], order[pair[1]] = pair[1], pair[0]
    return order


def _left_by(shown: Complexes, weight: Complexes) -> float:
    """Return the sum of squares of what one factor on all weights leaves of unbalances (M, P) that differ by mounting."""
    weight, shown = weight - weight.mean(axis=0), shown - shown.mean(axis=0)
    size = float(np.sum(np.abs(weight) ** 2))
    explained = float(np.abs(np.vdot(weight, shown)) ** 2) / size if size else 0.0
    return float(np.sum(np.abs(shown) ** 2)) - explained


def _chance(ratio: float, tried: int, free: int) -> float:
    """Return the chance of a ratio of sums of squares of `tried` and of `free` complex values that is as large."""
    return float(scipy.special.fdtrc(2 * tried, 2 * free, ratio * free / tried))


def _chance_of_largest(difference: Complexes) -> float:
    """Return an upper bound of the chance that one of the squares is so large a part of their sum (Cochran 1941)."""
    square = np.abs(difference - difference.mean(axis=0)) ** 2
    share = float(square.max() / max(float(square.sum()), 1e-300))
    return float(square.size * (1.0 - share) ** (square.size - 1))
