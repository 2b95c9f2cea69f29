"""Tests of a parameter's trend: a step and since when, creep, and slow drift with the time until a limit is reached.

Each series holds deviations from the baseline: the change over its standard deviation from run to run. Their mean and their
standard deviation come from a baseline of a few runs and are somewhat wrong, the same in every run. Limits of charts that
ignore this are passed far too often (Jensen et al. 2006, doi:10.1080/00224065.2006.11918623); here a chart's rate of false
alarms is the mean over what the true centre and scatter may be.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
import scipy
import scipy.special

from estimator.arrays import Floats
from estimator.trends import control_charts
from estimator.trends import drift as slow_drift
from estimator.trends.deviations import Whitening, comparable, element_distance, element_of
from estimator.trends.drift import Drift, TimeToLimit
from estimator.trends.parameter_vector import Point

RUN_LENGTH = 520.0
"""Average number of identifications between two false alarms of one chart: ten years of one a week."""
CUSUM_REFERENCE = 1.0
"""Half of the step that is found soonest, in standard deviations [-]: 2 σ, for a stiffness some 2 to 3 %."""
EWMA_WEIGHT = 0.2
"""Weight of the newest run [-]: the mean reaches over some nine."""
LONGEST_DRIFT = 104
"""Number of newest runs in which a drift is searched: two years of one a week."""
CENTRES = 7
"""Number of nodes of the Gauss-Hermite rule over the baseline's centre."""
SCATTERS = 10
"""Number of nodes of the Gauss-Legendre rule over the quantiles of the true scatter."""
LARGEST_LIMIT = 60.0
"""Limit at which the search for a chart's limit stops [-]."""


@dataclass(frozen=True)
class DatedPoint:
    """Result of one identification at a time.

    Attributes:
        time: Time [weeks].
        point: Values of its parameters.
    """

    time: float
    point: Point


@dataclass(frozen=True)
class Chart:
    """State of a control chart after the newest run.

    Attributes:
        value: Value of the chart, of an EWMA with sign [-].
        limit: Limit of the chart [-].
        began: Time of the change's likeliest first run [weeks] where the limit is passed; None otherwise, and of an EWMA.
        runs: Number of runs from that one on; None where there is none.
    """

    value: float
    limit: float
    began: float | None = None
    runs: int | None = None

    @property
    def passed(self) -> bool:
        """Return whether the chart signals now."""
        return abs(self.value) > self.limit


@dataclass(frozen=True)
class TrendTest:
    """Tests of one coordinate, or of an element's distance, over the runs since the baseline.

    Attributes:
        name: Name of the coordinate or element.
        element: Name of the element.
        runs: Number of runs.
        newest: Last change, or distance [-].
        step_up: CUSUM upwards.
        step_down: CUSUM downwards; None for a distance.
        creep: EWMA.
        drift: Drift per week of the change [1/week], of a logarithm where the parameter is fitted as one; None for too few
            runs.
    """

    name: str
    element: str
    runs: int
    newest: float
    step_up: Chart
    step_down: Chart | None
    creep: Chart
    drift: Drift | None


def trend_tests(
    baseline: Sequence[Point], readings: Sequence[DatedPoint], names: Sequence[str] | None = None
) -> tuple[TrendTest, ...]:
    """Test the trend of every coordinate that the baseline determines, or of some, through the readings that determine it.

    Sources: `control_charts`, `slow_drift`; limits after Jensen et al. (2006, module's docstring).

    Args:
        baseline: Points of the baseline's runs.
        readings: Readings behind the baseline, in ascending order of time.
        names: Names of the coordinates; None for all.

    Returns:
        Tests in the newest reading's order.

    Raises:
        ValueError: The baseline is empty, or the times do not ascend.
    """
    _require_ascending(readings)
    if not readings:
        return ()
    known = comparable(baseline, readings[-1].point)
    everything = Whitening.of(baseline, known)
    places = [{name: i for i, name in enumerate(one.point.names)} for one in readings]
    found = []
    for name in known:
        if names is not None and name not in names:
            continue
        white = everything.part([name])
        seen = [(one, place[name]) for one, place in zip(readings, places, strict=True) if name in place]
        time = np.array([one.time for one, _ in seen])
        change = (np.array([one.point.value[i] for one, i in seen]) - white.centre) / white.size
        own = np.array([one.point.covariance[i, i] for one, i in seen]) / white.size**2
        found.append(_tested(name, time, change, change / np.sqrt(own + white.scatter), white, both_ways=True))
    return tuple(found)


def distance_trends(
    baseline: Sequence[Point], readings: Sequence[DatedPoint], elements: Sequence[str] | None = None
) -> tuple[TrendTest, ...]:
    """Test the trend of every element's distance, or of some, through the readings that determine all the newest one does.

    Source: limits for estimated baselines, Jensen et al. (2006, doi:10.1080/00224065.2006.11918623).

    Args:
        baseline: Points of the baseline's runs.
        readings: Readings behind the baseline, in ascending order of time.
        elements: Names of the elements; None for all.

    Returns:
        Tests in the newest reading's order.

    Raises:
        ValueError: The baseline is empty, or the times do not ascend.
    """
    _require_ascending(readings)
    if not readings:
        return ()
    known = comparable(baseline, readings[-1].point)
    everything = Whitening.of(baseline, known)
    found = []
    for element in dict.fromkeys(element_of(name) for name in known):
        if elements is not None and element not in elements:
            continue
        names = [name for name in known if element_of(name) == element]
        white = everything.part(names)
        seen = [one for one in readings if set(names) <= set(one.point.names)]
        distances = [element_distance(white, one.point) for one in seen]
        # As many standard deviations as are as unlikely; a chance of 1 or 0 would be infinitely many.
        chance = np.clip([one.probability for one in distances], 1e-300, 1.0 - 1e-12)
        deviation = -scipy.special.ndtri(chance)
        distance = np.array([one.distance for one in distances])
        found.append(_tested(element, np.array([one.time for one in seen]), distance, deviation, white, both_ways=False))
    return tuple(found)


def time_to_change(drift: Drift, change: float, *, logarithmic: bool) -> TimeToLimit:
    """Compute the time until a drift reaches a change in the drift's own sense.

    Args:
        drift: The drift.
        change: Size of the change [-].
        logarithmic: Whether the drift is that of a logarithm; a fall by 100 % or more is never reached then.

    Returns:
        Times [weeks].
    """
    sign = math.copysign(1.0, drift.slope)
    if not logarithmic:
        return slow_drift.time_to_limit(drift, sign * change)
    if sign < 0.0 and change >= 1.0:
        return TimeToLimit(None, None, None)
    return slow_drift.time_to_limit(drift, math.log1p(sign * change))


@cache
def step_limit(*, runs: int, degrees_of_freedom: float) -> float:
    """Solve for the limit of the one-sided CUSUM with RUN_LENGTH, for a baseline of some runs.

    Source: limits for estimated baselines, Jensen et al. (2006, doi:10.1080/00224065.2006.11918623).

    Args:
        runs: Number of runs of the baseline.
        degrees_of_freedom: Degrees of freedom with which the scatter is known [-].

    Returns:
        Limit [-].
    """

    def rate(limit: float, shift: float, ratio: float) -> float:
        return 1.0 / control_charts.cusum_run_length(reference=CUSUM_REFERENCE / ratio, limit=limit / ratio, shift=shift)

    return _limit(rate, runs, degrees_of_freedom)


@cache
def creep_limit(*, runs: int, degrees_of_freedom: float) -> float:
    """Solve for the limit of the two-sided EWMA with RUN_LENGTH, for a baseline of some runs.

    Source: limits for estimated baselines, Jensen et al. (2006, doi:10.1080/00224065.2006.11918623).

    Args:
        runs: Number of runs of the baseline.
        degrees_of_freedom: Degrees of freedom with which the scatter is known [-].

    Returns:
        Limit in long-run standard deviations of the mean [-].
    """

    def rate(limit: float, shift: float, ratio: float) -> float:
        return 1.0 / control_charts.ewma_run_length(weight=EWMA_WEIGHT, limit=limit / ratio, shift=shift)

    return _limit(rate, runs, degrees_of_freedom)


def _limit(rate: Callable[[float, float, float], float], runs: int, freedom: float) -> float:
    """Solve for the limit at which the mean rate of false alarms is that of RUN_LENGTH.

    rate: by limit, shift and σ true / σ used.
    """
    centres, centre_weights = np.polynomial.hermite_e.hermegauss(CENTRES)
    quantiles, scatter_weights = np.polynomial.legendre.leggauss(SCATTERS)
    shifts = centres / math.sqrt(runs)
    ratios = np.sqrt(freedom / scipy.special.chdtri(freedom, (quantiles + 1.0) / 2.0))
    weights = np.outer(centre_weights, scatter_weights)
    weights /= weights.sum()

    def off(limit: float) -> float:
        rates = [[rate(limit, shift, ratio) for ratio in ratios.tolist()] for shift in shifts.tolist()]
        return math.log(RUN_LENGTH * float(np.sum(weights * np.array(rates))))

    largest = 4.0
    while off(largest) > 0.0 and largest < LARGEST_LIMIT:
        largest *= 1.5
    return float(scipy.optimize.brentq(off, 0.5, largest, xtol=1e-2))


def _tested(name: str, time: Floats, value: Floats, deviation: Floats, white: Whitening, *, both_ways: bool) -> TrendTest:
    freedom = float(np.round(np.min(white.degrees_of_freedom)))
    limit = step_limit(runs=white.count, degrees_of_freedom=freedom)
    mean = float(control_charts.ewma(deviation, weight=EWMA_WEIGHT)[-1])
    newest = slice(-LONGEST_DRIFT, None)
    return TrendTest(
        name=name,
        element=element_of(name),
        runs=time.size,
        newest=float(value[-1]),
        step_up=_step(time, deviation, limit),
        step_down=_step(time, -deviation, limit) if both_ways else None,
        creep=Chart(mean, creep_limit(runs=white.count, degrees_of_freedom=freedom)),
        drift=slow_drift.drift(time[newest], value[newest]) if time.size >= slow_drift.FEWEST else None,
    )


def _step(time: Floats, deviation: Floats, limit: float) -> Chart:
    value = float(control_charts.cusum(deviation, reference=CUSUM_REFERENCE)[-1])
    first = control_charts.change_began(deviation, reference=CUSUM_REFERENCE) if value > limit else None
    return Chart(value, limit) if first is None else Chart(value, limit, float(time[first]), time.size - first)


def _require_ascending(readings: Sequence[DatedPoint]) -> None:
    if any(later.time <= earlier.time for earlier, later in zip(readings, readings[1:], strict=False)):
        raise ValueError("the readings must ascend in time")
