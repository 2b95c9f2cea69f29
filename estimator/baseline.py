"""Deviation of a machine's parameters from its baseline, against the estimates' own errors and the run-to-run scatter."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.stats

from estimator.condensation import Floats

PRIOR_SCATTER = 0.02
"""Run-to-run standard deviation of ln k expected before any run was seen: 2 %."""
PRIOR_WEIGHT = 10.0
"""Degrees of freedom that this expectation counts for: a few runs say little about their own scatter."""


@dataclass(frozen=True)
class Point:
    """One identification's values of some parameters: names (N,), value (N,) and covariance (N, N)."""

    names: tuple[str, ...]
    value: Floats
    covariance: Floats

    def of(self, names: Sequence[str]) -> "Point":
        """The same for fewer parameters. Raises ValueError for a name that is not there."""
        missing = [name for name in names if name not in self.names]
        if missing:
            raise ValueError(f"not among the parameters: {', '.join(missing)}")
        index = [self.names.index(name) for name in names]
        return Point(tuple(names), self.value[index], self.covariance[np.ix_(index, index)])


@dataclass(frozen=True)
class CommonShift:
    """How far several parameters moved together from the baseline.

    shift: weighted mean of the parameters' changes; of logarithms, hence relative [-]. standard_error: with the run-to-run
    scatter and the baseline's own error. statistic: shift over standard error, distributed as Student's t with
    degrees_of_freedom while nothing has changed. probability: of such a shift or a larger one by chance.
    scatter: the run-to-run standard deviation that was used.
    """

    names: tuple[str, ...]
    shift: float
    standard_error: float
    statistic: float
    degrees_of_freedom: float
    probability: float
    scatter: float


def common_shift(baseline: Sequence[Point], now: Point, names: Sequence[str]) -> CommonShift:
    """Shift of `names` together, upwards, judged one-sided.

    The weights are those of generalised least squares for a common change, fixed by the baseline; the run-to-run scatter is
    the baseline's own beyond the estimates' errors, shrunk towards PRIOR_SCATTER. Raises ValueError for an empty baseline.
    """
    if not baseline:
        raise ValueError("a baseline needs at least one identification")
    points = [point.of(names) for point in baseline]
    current = now.of(names)
    count = len(points)
    centre = np.mean([point.value for point in points], axis=0)
    own = np.mean([point.covariance for point in points], axis=0)
    weight = np.linalg.solve(own + PRIOR_SCATTER**2 * np.eye(len(names)), np.ones(len(names)))
    weight /= weight.sum()

    shifts = np.array([weight @ (point.value - centre) for point in points])
    own_variance = float(weight @ own @ weight)
    prior = PRIOR_SCATTER**2 * float(weight @ weight)
    excess = max(0.0, float(shifts @ shifts) - (count - 1) * own_variance)
    freedom = PRIOR_WEIGHT + count - 1
    scatter = (PRIOR_WEIGHT * prior + excess) / freedom

    shift = float(weight @ (current.value - centre))
    variance = float(weight @ current.covariance @ weight) + own_variance / count + scatter * (1 + 1 / count)
    error = float(np.sqrt(variance))
    return CommonShift(
        names=tuple(names),
        shift=shift,
        standard_error=error,
        statistic=shift / error,
        degrees_of_freedom=freedom,
        probability=float(scipy.stats.t.sf(shift / error, freedom)),
        scatter=float(np.sqrt(scatter)),
    )
