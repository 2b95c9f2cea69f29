"""Whether a fit may be believed, and the words that say so."""

import math
from dataclasses import dataclass

import numpy as np

from estimator.fit import Fit, Problem
from estimator.noise import error_size

CHI_SQUARE_LIMIT = 5.0
"""With stated noise, a fit is accepted when χ²/dof is at most 1 plus this many standard deviations √(2/dof)."""
LARGEST_OUTLIER_PART = 0.1
"""A fit that leaves out more than this part of the phasors explains the wrong ones."""
FEW_OUTLIERS = 5
"""Fewer outliers than this say nothing about a channel."""
LARGEST_ESTIMATED_NOISE = 0.2
"""An estimated relative noise above this is no noise but a model that does not fit."""
SMALLEST_ESTIMATED_NOISE = 1e-5
"""An estimated relative noise below this is rounding: the data were computed."""
LARGEST_SERIAL_CORRELATION = 0.3
"""With estimated noise, residuals of neighbouring speeds may be as alike as this, plus five standard deviations."""


@dataclass(frozen=True)
class Verdict:
    """accepted: whether the fit may be used. words: why. degrees_of_freedom: of χ², at least 1."""

    accepted: bool
    words: str
    degrees_of_freedom: int


def accepted(chi_square: float, freedom: int) -> bool:
    """Whether χ² is no larger than the noise explains."""
    return chi_square / freedom <= 1.0 + CHI_SQUARE_LIMIT * math.sqrt(2.0 / freedom)


def judge(problem: Problem, found: Fit) -> Verdict:
    """Judge a fit by its χ², what it left out and, where its noise is estimated, the order in its residuals."""
    usable = int(np.count_nonzero(problem.measurement.usable))
    left_out = int(np.count_nonzero(found.outlier))
    freedom = max(1, 2 * (usable - left_out) - problem.coordinates.size)
    reduced, spread = found.chi_square / freedom, math.sqrt(2.0 / freedom)
    chi = f"χ²/dof {reduced:.3g}, expected 1 ± {spread:.2g}"
    if found.noise.estimated:
        chi = f"noise estimated as {100 * found.noise.relative:.2g} % and {found.noise.floor:.2g} m"
    outlying = f"; {left_out} of {usable} phasors left out as outliers{_worst_channel(problem, found)}" if left_out else ""
    if not found.converged:
        return Verdict(False, f"not converged, {chi}{outlying}", freedom)
    if left_out > LARGEST_OUTLIER_PART * usable:
        return Verdict(False, f"too much does not fit: {chi}{outlying}", freedom)
    if found.noise.estimated:
        return _judge_by_order(problem, found, f"{chi}{outlying}", freedom)
    if not accepted(found.chi_square, freedom):
        return Verdict(False, f"the model does not fit the data: {chi}{outlying}", freedom)
    if reduced < 1.0 - CHI_SQUARE_LIMIT * spread:
        return Verdict(True, f"accepted; the stated noise is too large: {chi}{outlying}", freedom)
    return Verdict(True, f"accepted: {chi}{outlying}", freedom)


def remark(problem: Problem, found: Fit) -> str:
    """What an accepted fit with stated noise should be told beside: a pattern that χ² is not sharp enough for, else nothing.

    Not a reason to refuse: the errors of overlapping measurements are alike as well.
    """
    if found.noise.estimated:
        return ""
    correlation, pairs = serial_correlation(problem, found)
    if correlation <= CHI_SQUARE_LIMIT / math.sqrt(2.0 * max(1, pairs)):
        return ""
    return (
        f"; residuals of neighbouring speeds are alike (correlation {correlation:.2g}): the model may be slightly wrong, "
        "or the samples overlap"
    )


def _judge_by_order(problem: Problem, found: Fit, words: str, freedom: int) -> Verdict:
    """With estimated noise χ² is as expected by construction; a model that does not fit leaves a pattern over speed."""
    if found.noise.relative <= SMALLEST_ESTIMATED_NOISE and found.noise.floor == 0.0:
        return Verdict(True, f"accepted; no noise to be seen: {words}", freedom)
    if found.noise.relative > LARGEST_ESTIMATED_NOISE:
        return Verdict(False, f"the model does not fit the data: {words}", freedom)
    correlation, pairs = serial_correlation(problem, found)
    limit = LARGEST_SERIAL_CORRELATION + 5.0 / math.sqrt(2.0 * max(1, pairs))
    if correlation > limit:
        message = f"residuals of neighbouring speeds are alike, correlation {correlation:.2g}, at most {limit:.2g} is noise"
        return Verdict(False, f"the model does not fit the data: {message}; {words}", freedom)
    return Verdict(True, f"accepted: {words}", freedom)


def serial_correlation(problem: Problem, found: Fit) -> tuple[float, int]:
    """Correlation of weighted residuals between neighbouring speeds of a channel, over all channels, and its pairs' number."""
    model = problem.model(found.theta)
    error = error_size(found.noise, np.abs(model), problem.measurement.scatter)
    used = problem.measurement.usable & ~found.outlier & (error > 0.0)
    size = np.divide(problem.measurement.phasor - model, error, out=np.zeros_like(model), where=used)
    order = np.lexsort((problem.measurement.speed, problem.measurement.direction))
    size, used = size[order], used[order]
    both = used[1:] & used[:-1]
    power = float(np.sum(np.abs(size[1:][both]) ** 2 + np.abs(size[:-1][both]) ** 2)) / 2
    pairs = int(np.count_nonzero(both))
    return (float(np.sum((size[1:] * size[:-1].conj())[both].real)) / power if power > 0.0 else 0.0), pairs


def _worst_channel(problem: Problem, found: Fit) -> str:
    """Where most of the outliers are, if one channel has more than half of them."""
    counts = np.count_nonzero(found.outlier, axis=0)
    worst = int(np.argmax(counts))
    if len(counts) < 2 or counts.sum() < FEW_OUTLIERS or counts[worst] <= counts.sum() / 2:
        return ""
    return f", most of them of {problem.train.channels[worst]}"
