"""Parameters that have moved with a cause: those of its elements that the newest run determines, as its deviations tell them.

The numbers are those of `GET /machines/{id}/deviations` for the same identification: what an alert says of a parameter is what
the table beside it says.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from estimator.machine.parameter_description import describe, is_direct
from estimator.trends.covariates import Adjustment, adjustment
from estimator.trends.deviations import ParameterDeviation, deviations
from estimator.trends.parameter_vector import Point
from service.monitoring.assessment.context import AssessmentContext, MovedParameter


def moved_parameters(context: AssessmentContext, units: Mapping[str, str]) -> tuple[MovedParameter, ...]:
    """Return the deviation of each parameter of the newest run from the baseline; none where they cannot be compared.

    units: SI unit by name.
    """
    compared = context.compared
    if compared is None:
        return ()
    baseline = adjusted_baseline(context)
    now = _adjustment(context).adjusted(*compared.newest)
    return tuple(_moved(one, baseline, now, units) for one in deviations(baseline, now).parameters)


def adjusted_baseline(context: AssessmentContext) -> list[Point]:
    """Return the baseline's points under its mean operating conditions; none where they are not known."""
    follows = _adjustment(context)
    return [follows.adjusted(point, said) for point, said in context.compared.baseline] if context.compared else []


def _adjustment(context: AssessmentContext) -> Adjustment:
    baseline = context.compared.baseline if context.compared else ()
    return adjustment([point for point, _ in baseline], [said for _, said in baseline], context.machine.conditions)


@dataclass(frozen=True)
class _Change:
    """Change of a real parameter in its unit."""

    before: float
    after: float

    @classmethod
    def of(cls, name: str, baseline: Sequence[Point], now: Point) -> "_Change":
        before = math.fsum(_value(one, name) for one in baseline) / len(baseline)
        after = _value(now, name)
        return cls(math.exp(before), math.exp(after)) if is_direct(name) else cls(before, after)


def _moved(one: ParameterDeviation, baseline: Sequence[Point], now: Point, units: Mapping[str, str]) -> MovedParameter:
    if one.vector is not None:
        change = abs(one.vector)
    else:
        found = _Change.of(one.name, baseline, now)
        change = found.after - found.before
    return MovedParameter(
        parameter=one.name,
        element=one.element,
        change=change,
        unit=units.get(describe(one.name).whole, units.get(one.name)),
        per_cent=100.0 * one.change,
        lower_per_cent=100.0 * one.lower,
        upper_per_cent=100.0 * one.upper,
        sigma=one.sigma,
    )


def _value(point: Point, name: str) -> float:
    return float(point.value[point.names.index(name)])
