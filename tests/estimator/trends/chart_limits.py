"""Limits at which control charts of a well known baseline have a stated average run length: the textbook's."""

import math
from collections.abc import Callable

import scipy.optimize

from estimator.trends.control_charts import cusum_run_length, ewma_run_length


def cusum_limit(*, reference: float, run_length: float) -> float:
    """The limit of the upper CUSUM."""
    return _limit(lambda limit: cusum_run_length(reference=reference, limit=limit), run_length)


def ewma_limit(*, weight: float, run_length: float) -> float:
    """The limit of the two-sided EWMA, in long-run standard deviations of the mean."""
    return _limit(lambda limit: ewma_run_length(weight=weight, limit=limit), run_length)


def _limit(length: Callable[[float], float], wanted: float) -> float:
    def off(limit: float) -> float:
        return math.log(length(limit) / wanted)

    large = 1.0
    while off(large) < 0.0:  # far beyond the limit the run length overflows
        large *= 1.5
    return float(scipy.optimize.brentq(off, 1e-3, large, xtol=1e-6))
