"""How fast parameters have been changing lately: a rate that a person may set a limit on.

The slope of the newest runs by Theil and Sen, which a few outliers and a single step hardly move, and only where the test of
Mann and Kendall, corrected after Hamed and Rao, leaves no doubt that there is a drift at all.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator import slow_drift
from estimator.between_run_scatter import sizes
from estimator.deviation import element_of
from estimator.parameters import is_direct
from estimator.trend_tests import Reading

WINDOW = 16
"""Newest runs that the rate is that of."""
FEWEST = 10
"""Fewer cannot make a drift certain: for nine runs in perfect order the test's probability is 3e-4."""
CHANCE = 1e-4
"""Probability, without a drift, with which one parameter's test may take the newest runs for one."""


@dataclass(frozen=True)
class ParameterRate:
    """How fast one coordinate changes: part of its size per week [1/week], of a direct term of its own value.

    lower, upper: 95 % interval. probability: of such an order of the runs without a drift. runs: that were looked at; since:
    time of the first of them [weeks].
    """

    name: str
    element: str
    per_week: float
    lower: float
    upper: float
    probability: float
    runs: int
    since: float

    @property
    def certain(self) -> bool:
        """Whether there is a drift, however fast."""
        return self.probability <= CHANCE


def rates_of_change(readings: Sequence[Reading]) -> tuple[ParameterRate, ...]:
    """Rates of all coordinates of the newest reading that at least FEWEST of the newest WINDOW readings determine.

    readings: in ascending order of time, those of the baseline among them or not. Raises ValueError for times that do not
    ascend.
    """
    lately = readings[-WINDOW:]
    if len(lately) < FEWEST:
        return ()
    names = lately[-1].point.names
    values = np.array([[_value(one, name) for name in names] for one in lately])
    size = sizes(names, np.nanmean(values, axis=0))
    time = np.array([one.time for one in lately])
    found = []
    for column, name in enumerate(names):
        known = np.isfinite(values[:, column])
        if np.count_nonzero(known) < FEWEST:
            continue
        drift = slow_drift.drift(time[known], values[known, column] / size[column])
        slopes = (drift.slope, drift.slope_lower, drift.slope_upper)
        slope, lower, upper = (math.expm1(one) if is_direct(name) else one for one in slopes)
        first = float(time[known][0])
        count = int(np.count_nonzero(known))
        found.append(ParameterRate(name, element_of(name), slope, lower, upper, drift.probability, count, first))
    return tuple(found)


def _value(reading: Reading, name: str) -> float:
    names = reading.point.names
    return float(reading.point.value[names.index(name)]) if name in names else math.nan
