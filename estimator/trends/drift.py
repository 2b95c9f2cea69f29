"""Slow drift of a parameter over time.

A slope that outliers do not move, a test that knows about serial correlation, and the time until a limit is reached. The slope
is Theil's and Sen's (doi:10.1080/01621459.1968.10480934), the test Mann's and Kendall's, its variance corrected for serial
correlation after Hamed and Rao (doi:10.1016/S0022-1694(97)00125-X).
"""

import math
from dataclasses import dataclass

import numpy as np
import scipy.special

from estimator.arrays import Floats

FEWEST = 4
"""Least number of values: fewer show no drift."""
SIGNIFICANT_LAG = 0.05
"""Chance with which the correlation of one lag counts although there is none [-]."""
SMALLEST_CORRECTION = 1.0
"""Least factor on the variance [-]: negative correlation, which short series show by chance, does not make the test sharper.
With it the corrected variance can even become negative, and a twentieth of false alarms a tenth.
"""


@dataclass(frozen=True)
class Drift:
    """Drift of a parameter, in the units of its values and times.

    Attributes:
        slope: Slope [unit of the value per unit of time].
        slope_lower: Lower end of the slope's 95 % interval [unit of the slope].
        slope_upper: Upper end of the slope's 95 % interval [unit of the slope].
        level: Fitted line at the newest time [unit of the value].
        statistic: Statistic of the corrected test, standard normal without drift [-].
        probability: Probability of one as large, either way, without drift [-].
        correction: Factor on the variance for serial correlation [-].
    """

    slope: float
    slope_lower: float
    slope_upper: float
    level: float
    statistic: float
    probability: float
    correction: float


@dataclass(frozen=True)
class TimeToLimit:
    """Time until a limit is reached, in the unit of time; None for never.

    Attributes:
        expected: Time by the slope [unit of time].
        earliest: Earliest time by the slope's interval [unit of time].
        latest: Latest time by the slope's interval [unit of time].
    """

    expected: float | None
    earliest: float | None
    latest: float | None


def drift(time: Floats, value: Floats) -> Drift:
    """Estimate the drift of values at times of any spacing.

    Slope of Theil and Sen (doi:10.1080/01621459.1968.10480934), test of Mann and Kendall corrected after Hamed and Rao
    (doi:10.1016/S0022-1694(97)00125-X).

    Args:
        time: Times (n,), ascending [any unit].
        value: Values (n,) [any unit].

    Returns:
        The drift.

    Raises:
        ValueError: There are fewer than four values, or the times do not ascend.
    """
    if time.size < FEWEST or time.shape != value.shape:
        raise ValueError(f"{time.size} times and {value.size} values: at least {FEWEST} of each are needed")
    if np.any(np.diff(time) <= 0.0):
        raise ValueError("the times must ascend")
    first, second = np.triu_indices(time.size, 1)
    slopes = np.sort((value[second] - value[first]) / (time[second] - time[first]))
    slope = float(np.median(slopes))
    concordance = float(np.sum(np.sign(value[second] - value[first])))
    correction = serial_correction(value - slope * time)
    variance = _variance(value) * correction
    statistic = (concordance - math.copysign(1.0, concordance)) / math.sqrt(variance) if concordance and variance else 0.0
    half = float(scipy.special.ndtri(0.975)) * math.sqrt(variance)
    return Drift(
        slope=slope,
        slope_lower=_ordered(slopes, (slopes.size - half) / 2.0 - 1.0),
        slope_upper=_ordered(slopes, (slopes.size + half) / 2.0),
        level=float(np.median(value - slope * time)) + slope * float(time[-1]),
        statistic=statistic,
        probability=float(2.0 * scipy.special.ndtr(-abs(statistic))),
        correction=correction,
    )


def serial_correction(residual: Floats) -> float:
    """Compute the factor on the variance of Kendall's S by serial correlation: n/n* of Hamed and Rao, Eq. 15.

    Source: Hamed and Rao (doi:10.1016/S0022-1694(97)00125-X).

    Args:
        residual: Residuals (n,) whose ranks are correlated [any unit].

    Returns:
        Factor [-].
    """
    count = residual.size
    rank = _ranks(residual)
    rank = rank - rank.mean()
    power = float(rank @ rank)
    if power == 0.0:
        return 1.0
    lag = np.arange(1, count)
    correlation = np.correlate(rank, rank, mode="full")[count:] / power
    limit = float(scipy.special.ndtri(1.0 - SIGNIFICANT_LAG / 2.0)) / math.sqrt(count)
    counted = np.where(np.abs(correlation) > limit, correlation, 0.0)
    weight = (count - lag) * (count - lag - 1) * (count - lag - 2)
    factor = 1.0 + 2.0 / (count * (count - 1) * (count - 2)) * float(weight @ counted)
    return max(factor, SMALLEST_CORRECTION)


def time_to_limit(found: Drift, limit: float) -> TimeToLimit:
    """Compute the time until the drift reaches a limit, counted from the newest time.

    Args:
        found: The drift.
        limit: The limit [unit of the value].

    Returns:
        Times: 0 when the limit is reached, None when the drift moves away from it.
    """
    distance = limit - found.level
    times = [_time_to_reach(distance, slope) for slope in (found.slope, found.slope_lower, found.slope_upper)]
    ends = [one for one in times[1:] if one is not None]
    return TimeToLimit(
        expected=times[0], earliest=min(ends, default=None), latest=max(ends) if len(ends) == len(times[1:]) else None
    )


def _time_to_reach(distance: float, slope: float) -> float | None:
    if distance == 0.0:
        return 0.0
    return distance / slope if slope * distance > 0.0 else None


def _variance(value: Floats) -> float:
    """Compute the variance of Kendall's S without serial correlation, ties counted."""
    count = value.size
    ties = np.unique(value, return_counts=True)[1].astype(float)
    whole = count * (count - 1) * (2 * count + 5)
    return (whole - float(np.sum(ties * (ties - 1) * (2 * ties + 5)))) / 18.0


def _ordered(slopes: Floats, place: float) -> float:
    """Interpolate the order statistic at a place that may lie between two."""
    return float(np.interp(place, np.arange(slopes.size), slopes))


def _ranks(values: Floats) -> Floats:
    """Compute ranks from 1; equal values share the mean of theirs."""
    _, place, counts = np.unique(values, return_inverse=True, return_counts=True)
    ranks: Floats = (np.cumsum(counts) - (counts - 1) / 2.0)[place]
    return ranks
