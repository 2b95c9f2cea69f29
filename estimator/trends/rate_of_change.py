"""Rate of change of parameters over the newest runs, on which a person may set a limit.

It is the slope of the newest runs by Theil and Sen (doi:10.1080/01621459.1968.10480934), which a few outliers and a single
step hardly change. There is none unless the test of Mann and Kendall, corrected after Hamed and Rao
(doi:10.1016/S0022-1694(97)00125-X), is significant.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.machine.parameter_description import is_direct
from estimator.trends import drift as slow_drift
from estimator.trends.between_run_scatter import sizes
from estimator.trends.deviations import element_of
from estimator.trends.trend_tests import DatedPoint

WINDOW = 16
"""Number of newest runs that the rate is computed from."""
FEWEST = 10
"""Least number of runs for a drift to be certain: for nine runs in perfect order the test's probability is 3e-4."""
CHANCE = 1e-4
"""Probability, without a drift, with which one parameter's test may take the newest runs for one [-]."""


@dataclass(frozen=True)
class ParameterRate:
    """Rate of change of one coordinate.

    Attributes:
        name: Name of the coordinate.
        element: Name of its element.
        per_week: Change per week as a part of its size, of a direct term of its own value [1/week].
        lower: Lower end of the 95 % interval [1/week].
        upper: Upper end of the 95 % interval [1/week].
        probability: Probability of such an order of the runs without a drift [-].
        runs: Number of runs used.
        since: Time of the first of them [weeks].
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
        """Return whether there is a drift, however fast."""
        return self.probability <= CHANCE


def rates_of_change(readings: Sequence[DatedPoint]) -> tuple[ParameterRate, ...]:
    """Compute the rates of all coordinates of the newest reading that at least FEWEST of the newest WINDOW readings determine.

    Theil and Sen's slope, test of Mann and Kendall (sources in `slow_drift`).

    Args:
        readings: Readings in ascending order of time, those of the baseline among them or not.

    Returns:
        Rates in the order of the newest reading's names.

    Raises:
        ValueError: The times do not ascend.
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


def _value(reading: DatedPoint, name: str) -> float:
    names = reading.point.names
    return float(reading.point.value[names.index(name)]) if name in names else math.nan
