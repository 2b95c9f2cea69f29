"""Rates of change: their size, what makes one certain, and that steady machines have none."""

import math

import numpy as np
import pytest

from estimator.trends.parameter_vector import Point
from estimator.trends.rate_of_change import CHANCE, FEWEST, WINDOW, ParameterRate, rates_of_change
from estimator.trends.trend_tests import DatedPoint

NAMES = ("bearing.B1.kxx", "bearing.B1.kxy", "bearing.B1.kyy", "disc.D1.unbalance.real", "disc.D1.unbalance.imaginary")
CENTRE = np.array([math.log(1e6), 1e5, math.log(4e6), 3e-3, 4e-3])
SIZE = np.array([1.0, 2e6, 1.0, 5e-3, 5e-3])


def readings(
    per_week: dict[str, float], *, weeks: int = WINDOW, scatter: float = 0.0, unknown: tuple[str, ...] = (), step: float = 0.0
) -> list[DatedPoint]:
    """A run a week; step: of all parameters in the middle. Every other run does not determine the unknown ones."""
    rng = np.random.default_rng(5)
    slope = np.array([per_week.get(name, 0.0) for name in NAMES])
    found = []
    for week in range(weeks):
        moved = slope * (week - (weeks - 1) / 2) + scatter * rng.standard_normal(SIZE.size) + step * (week >= weeks / 2)
        whole = Point(NAMES, CENTRE + moved * SIZE, np.eye(SIZE.size))
        found.append(DatedPoint(float(week), whole.of([n for n in NAMES if not (week % 2 == 0 and n in unknown)])))
    return found


def by_name(found: tuple[ParameterRate, ...]) -> dict[str, ParameterRate]:
    return {one.name: one for one in found}


def test_rates_are_parts_of_the_parameters_own_sizes() -> None:
    found = by_name(
        rates_of_change(readings({"bearing.B1.kxx": 0.02, "bearing.B1.kxy": 0.03, "disc.D1.unbalance.imaginary": -0.05}))
    )
    assert found["bearing.B1.kxx"].per_week == pytest.approx(math.expm1(0.02))
    assert found["bearing.B1.kxy"].per_week == pytest.approx(0.03, rel=0.01)
    assert found["disc.D1.unbalance.imaginary"].per_week == pytest.approx(-0.05, rel=0.01)
    assert found["bearing.B1.kxx"].probability <= CHANCE
    assert found["bearing.B1.kyy"].per_week == 0.0
    assert not found["bearing.B1.kyy"].certain


def test_the_interval_holds_a_rate_under_scatter() -> None:
    one = by_name(rates_of_change(readings({"bearing.B1.kxx": 0.01}, scatter=0.01)))["bearing.B1.kxx"]
    assert one.lower < math.expm1(0.01) < one.upper
    assert one.certain


def test_one_step_is_no_rate() -> None:
    assert not any(one.certain for one in rates_of_change(readings({}, scatter=0.01, step=0.1)))


def test_too_few_runs_have_no_rate() -> None:
    fast = {"bearing.B1.kxx": 0.1, "bearing.B1.kyy": 0.1}
    assert rates_of_change(readings(fast, weeks=FEWEST - 1)) == ()
    found = by_name(rates_of_change(readings(fast, unknown=("bearing.B1.kxx",))))
    assert "bearing.B1.kxx" not in found
    assert found["bearing.B1.kyy"].runs == WINDOW


def test_only_the_newest_runs_count() -> None:
    found = by_name(rates_of_change(readings({"bearing.B1.kxx": 0.02}, weeks=40)))
    assert found["bearing.B1.kxx"].runs == WINDOW
    assert found["bearing.B1.kxx"].since == 40.0 - WINDOW


def test_perfect_order_of_the_fewest_runs_is_just_certain() -> None:
    (one,) = rates_of_change(
        [DatedPoint(one.time, one.point.of(NAMES[:1])) for one in readings({NAMES[0]: 0.02}, weeks=FEWEST)]
    )
    assert 0.5 * CHANCE < one.probability < CHANCE
