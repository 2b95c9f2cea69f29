"""Findings of parameters that change faster than a person allows: one per element, for its fastest parameter."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from estimator.diagnosis.change_progress import LimitAhead
from estimator.machine.parameter_description import describe, is_direct
from estimator.trends.parameter_vector import Point
from estimator.trends.rate_of_change import ParameterRate, rates_of_change
from estimator.trends.trend_tests import DatedPoint, time_to_change, trend_tests
from service.alerts.lifecycle import Severity
from service.monitoring.rules.drift_rule import RATE_OF_CHANGE
from service.monitoring.rules.limits import Limits, deviation_rule, severity_of

FILM_NUMBERS = frozenset(
    {"clearance", "viscosity", "viscosity_factor", "viscosity_ratio", "viscosity_slope", "elevation_x", "elevation_y"}
)
"""Numbers of oil films, whose drifts are the seasons' or are judged by the diagnosis in their own units."""


@dataclass(frozen=True)
class RateFinding:
    """An element whose fastest parameter drifts beyond a limit, with the severity.

    change_per_cent: how far it is from its baseline by now; None where it has none. ahead: when its size reaches the danger
    limit of its element, None where there is none or it moves away from it.
    """

    element: str
    rate: ParameterRate
    severity: Severity
    change_per_cent: float | None = None
    ahead: LimitAhead | None = None


def rate_findings(
    limits: Limits, readings: Sequence[DatedPoint], present: Mapping[str, Severity] | None = None
) -> tuple[RateFinding, ...]:
    """Return the elements that drift too fast as of the newest reading.

    readings: comparable, in ascending order of time. present: severity of the open alert of this rule, by element. The caller
    applies the rule's delays, with the readings up to each identification. Raises as `rates_of_change`.
    """
    fastest: dict[str, ParameterRate] = {}
    for rate in rates_of_change(readings):
        if not rate.certain or describe(rate.element).element_kind not in RATE_OF_CHANGE.elements:
            continue
        if describe(rate.name).quantity in FILM_NUMBERS:
            continue
        if rate.element not in fastest or abs(rate.per_week) > abs(fastest[rate.element].per_week):
            fastest[rate.element] = rate
    found = []
    for element, rate in fastest.items():
        held = (present or {}).get(element)
        severity = severity_of(limits, RATE_OF_CHANGE.name, rate=100 * rate.per_week, present=held, element=element)
        if severity is not None:
            found.append(RateFinding(element, rate, severity))
    return tuple(found)


def with_times_to_limits(
    found: Sequence[RateFinding], limits: Limits, baseline: Sequence[Point], readings: Sequence[DatedPoint]
) -> tuple[RateFinding, ...]:
    """Return drifts with the change so far and the time to the danger limit of its size, as trend tests tell them.

    baseline: its runs' points, comparable with the readings; none where they are not known.
    """
    return tuple(_with_time_to_limit(one, limits, baseline, readings) for one in found) if baseline else tuple(found)


def _with_time_to_limit(
    one: RateFinding, limits: Limits, baseline: Sequence[Point], readings: Sequence[DatedPoint]
) -> RateFinding:
    tests = trend_tests(baseline, readings, [one.rate.name])
    if not tests or tests[0].drift is None or describe(one.rate.name).component is not None:
        return one
    (test,) = tests
    direct = is_direct(one.rate.name)
    newest = 100.0 * (math.expm1(test.newest) if direct else test.newest)
    rule = deviation_rule(one.element)
    level = None if rule is None else limits.rule(rule, one.element).danger
    if level is None or level.per_cent is None or test.drift is None or abs(newest) >= level.per_cent:
        return replace(one, change_per_cent=newest)
    time = time_to_change(test.drift, level.per_cent / 100.0, logarithmic=direct)
    return replace(one, change_per_cent=newest, ahead=LimitAhead(level.per_cent, time.expected, time.earliest, time.latest))
