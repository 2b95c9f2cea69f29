"""Tests which drifts a person is told of: those that are certain, beyond the machine's own limits, one for each element."""

import math
from typing import Any

import numpy as np
import pytest

from estimator.trends.parameter_vector import Point
from estimator.trends.trend_tests import DatedPoint
from service.alerts.lifecycle import Severity
from service.monitoring.assessment.rate_of_change import RateFinding, rate_findings, with_times_to_limits
from service.monitoring.rules.limits import Limits

NAMES = ("bearing.B2.kxx", "bearing.B2.kyy", "coupling.C1.kxx", "probe.B2X.gain.real")


def drifting(per_week: tuple[float, ...], *, scatter: float = 0.002) -> list[DatedPoint]:
    rng = np.random.default_rng(8)
    return [
        DatedPoint(float(week), Point(NAMES, np.array(per_week) * week + scatter * rng.standard_normal(4), 1e-6 * np.eye(4)))
        for week in range(16)
    ]


def found(per_week: tuple[float, ...], present: dict[str, Severity] | None = None, **rules: Any) -> tuple[RateFinding, ...]:
    return rate_findings(Limits.model_validate(rules), drifting(per_week), present)


def test_the_fastest_parameter_speaks_for_its_element() -> None:
    (bearing, coupling) = found((0.006, -0.03, 0.007, 0.1))
    assert (bearing.element, bearing.rate.name, bearing.severity) == ("bearing.B2", "bearing.B2.kyy", Severity.DANGER)
    assert (coupling.element, coupling.severity) == ("coupling.C1", Severity.ALERT)
    assert coupling.rate.per_week == np.clip(coupling.rate.per_week, math.expm1(0.006), math.expm1(0.008))


def test_a_certain_drift_below_the_limit_is_none() -> None:
    assert found((0.004, 0.0, 0.0, 0.0)) == ()
    wary: dict[str, Any] = {"rate_of_change": {"alert": {"rate_per_cent_per_week": 0.3}}}
    assert [one.element for one in found((0.004, 0.0, 0.0, 0.0), **wary)] == ["bearing.B2"]


def test_an_open_alert_is_held_down_to_the_hysteresis() -> None:
    slow = (0.0045, 0.0, 0.0, 0.0)
    assert found(slow) == ()
    (held,) = found(slow, {"bearing.B2": Severity.ALERT})
    assert held.severity is Severity.ALERT
    assert found(slow, {"coupling.C1": Severity.ALERT}) == ()


def test_an_element_may_drift_faster_where_a_person_says_so() -> None:
    rule = {"alert": {"rate_per_cent_per_week": 9}}
    assert found((0.03, 0.0, 0.0, 0.0), elements={"bearing.B2": {"rate_of_change": rule}}) == ()


def test_a_large_slope_that_may_be_chance_is_none() -> None:
    wild = rate_findings(Limits(), drifting((0.006, 0.0, 0.0, 0.0), scatter=0.1))
    assert wild == ()


def test_a_season_of_oil_drifts_and_is_no_rate() -> None:
    """Viscosities follow the year by several per cent a week; the diagnosis judges numbers of films in their own units."""
    names = ("bearing.B2.viscosity", "oil.MAIN.viscosity_factor", "bearing.B2.elevation_y", "bearing.B2.clearance")
    rng = np.random.default_rng(8)
    drifted = [
        DatedPoint(float(week), Point(names, 0.03 * week + 0.002 * rng.standard_normal(4), 1e-6 * np.eye(4)))
        for week in range(16)
    ]
    assert rate_findings(Limits(), drifted, None) == ()


def test_a_drift_is_reported_with_the_time_to_the_limit_of_its_size() -> None:
    runs = drifting((0.006, 0.0, 0.0, 0.0))
    healthy = [Point(NAMES, 0.002 * np.random.default_rng(3).standard_normal(4), 1e-6 * np.eye(4)) for _ in range(5)]
    (told,) = with_times_to_limits(rate_findings(Limits(), runs), Limits(), healthy, runs)
    assert told.change_per_cent == pytest.approx(100 * math.expm1(0.006 * 15), abs=1.0)
    assert told.ahead is not None
    assert told.ahead.limit == 25.0
    assert told.ahead.expected == pytest.approx((math.log(1.25) - 0.09) / 0.006, rel=0.15)
    assert told.ahead.earliest is not None
    assert told.ahead.expected is not None
    assert told.ahead.latest is not None
    assert told.ahead.earliest <= told.ahead.expected <= told.ahead.latest
    (unknown,) = with_times_to_limits(rate_findings(Limits(), runs), Limits(), [], runs)
    assert (unknown.change_per_cent, unknown.ahead) == (None, None)
