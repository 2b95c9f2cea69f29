"""Findings of parameters that change faster than a person allows: one per element, for its fastest parameter."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from estimator.machine.parameter_description import describe
from estimator.trends.deviations import parameter_of
from estimator.trends.rate_of_change import ParameterRate, rates_of_change
from estimator.trends.trend_tests import Reading
from service.alerts.lifecycle import Severity
from service.monitoring.finding_rules import RATE_OF_CHANGE
from service.monitoring.limits import Limits, severity_of

FILM_NUMBERS = frozenset({"clearance", "viscosity", "viscosity_factor", "viscosity_slope", "elevation_x", "elevation_y"})
"""Numbers of oil films, whose drifts are the seasons' or are judged by the diagnosis in their own units."""


@dataclass(frozen=True)
class RateFinding:
    """An element whose fastest parameter drifts beyond a limit, with the severity."""

    element: str
    rate: ParameterRate
    severity: Severity

    @property
    def message(self) -> str:
        """Return the alert's sentence."""
        one = self.rate
        return (
            f"{parameter_of(one.name)} drifts by {100 * one.per_week:+.2g} % a week "
            f"({100 * one.lower:+.2g} to {100 * one.upper:+.2g}) over the last {one.runs} runs"
        )


def rate_findings(
    limits: Limits, readings: Sequence[Reading], present: Mapping[str, Severity] | None = None
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
