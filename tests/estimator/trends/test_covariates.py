"""Adjustment to mean conditions: against the ridge in closed form, a joint posterior, drawn baselines, and doing nothing."""

import numpy as np
import pytest
from numpy.typing import NDArray

from estimator.machine.rules import Condition
from estimator.trends.covariates import FEWEST_RUNS, Measured, adjustment
from estimator.trends.parameter_vector import Point

Floats = NDArray[np.float64]
NAMES = ("bearing.B1.kxx", "bearing.B1.kyy", "coupling.C1.kxx")
OIL = Condition(name="oil", unit="degC")
LOAD = Condition(name="load", unit="%", usual_change=30.0)


def points(values: Floats, covariance: Floats) -> list[Point]:
    return [Point(NAMES[: values.shape[1]], value, covariance) for value in values]


def measured(table: Floats, *names: str) -> list[Measured]:
    return [dict(zip(names, map(float, row), strict=True)) for row in table]


def test_one_condition_has_the_ridge_in_closed_form() -> None:
    """b = Σxy/(Σx² + v/s²), its variance v/(Σx² + v/s²), for s = 1 % per 10 K."""
    temperature = np.array([50.0, 54.0, 61.0, 47.0, 58.0])
    values = np.array([0.01, 0.0, -0.03, 0.02, -0.01])[:, None]
    error, scatter = 0.005, 0.02
    found = adjustment(points(values, np.array([[error**2]])), measured(temperature[:, None], "oil"), [OIL])
    x, y = temperature - temperature.mean(), values[:, 0] - values.mean()
    variance, prior = error**2 + scatter**2, 0.001
    weight = x @ x + variance / prior**2
    assert found.slope == pytest.approx(np.array([[x @ y / weight]]), rel=1e-12)
    assert found.mean == pytest.approx([54.0])
    moved = found.adjusted(Point(NAMES[:1], np.array([0.5]), np.array([[1e-4]])), {"oil": 74.0})
    assert moved.value == pytest.approx([0.5 - 20.0 * x @ y / weight], rel=1e-12)
    assert moved.covariance == pytest.approx(np.array([[1e-4 + 400.0 * variance / weight]]), rel=1e-12)


def test_several_are_the_joint_posterior_of_all_slopes() -> None:
    """Precision of vec B: CᵀC ⊗ V⁻¹ + D⁻¹ ⊗ 1, all written out."""
    rng = np.random.default_rng(1)
    table = rng.normal([55.0, 70.0], [5.0, 15.0], (7, 2))
    mixture = rng.standard_normal((3, 3)) * 0.01
    own = mixture @ mixture.T + 1e-5 * np.eye(3)
    values = rng.normal(0.0, 0.03, (7, 3))
    found = adjustment(points(values, own), measured(table, "oil", "load"), [OIL, LOAD])
    change, noise = table - table.mean(axis=0), np.linalg.inv(own + 0.02**2 * np.eye(3))
    prior = np.diag(np.array([0.01 / 10.0, 0.01 / 30.0]) ** -2)
    covariance = np.linalg.inv(np.kron(change.T @ change, noise) + np.kron(prior, np.eye(3)))
    mean = covariance @ (noise @ (values - values.mean(axis=0)).T @ change).T.reshape(-1)
    assert found.slope == pytest.approx(mean.reshape(2, 3).T, rel=1e-9)
    moved = found.adjusted(Point(NAMES, np.zeros(3), own), {"oil": 70.0, "load": 20.0})
    step = np.kron((np.array([70.0, 20.0]) - found.mean)[None, :], np.eye(3))
    assert moved.value == pytest.approx(-step @ mean, rel=1e-9)
    assert moved.covariance == pytest.approx(own + step @ covariance @ step.T, rel=1e-9)


def test_drawn_slopes_scatter_as_stated() -> None:
    """Of 400 baselines with slopes from the prior, squared errors over stated variances are χ²: their mean is 1 ± 0.04."""
    rng = np.random.default_rng(2)
    own = np.diag([0.005, 0.01, 0.02]) ** 2
    ratios = []
    for _ in range(400):
        slope = rng.normal(0.0, 0.001, 3)
        temperature = rng.normal(55.0, 6.0, 6)
        errors = rng.normal(0.0, 0.02, (6, 3)) + rng.multivariate_normal(np.zeros(3), own, 6)
        values = np.outer(temperature - 55.0, slope) + errors
        found = adjustment(points(values, own), measured(temperature[:, None], "oil"), [OIL])
        moved = found.adjusted(Point(NAMES, 15.0 * slope, np.zeros((3, 3))), {"oil": float(found.mean[0]) + 15.0})
        ratios.append(moved.value**2 / np.diag(moved.covariance))
    assert np.mean(ratios) == pytest.approx(1.0, abs=4 * np.sqrt(2 / 1200))


def test_many_runs_take_the_season_out() -> None:
    """2 % of stiffness over a year of oil temperature: after a baseline of nine months less than a quarter is left."""
    rng = np.random.default_rng(3)
    week = np.arange(52)
    temperature = 55.0 + 12.0 * np.sin(2 * np.pi * week / 52)
    season = -0.02 * np.sin(2 * np.pi * week / 52)[:, None]
    values = season + rng.normal(0.0, 0.005, (52, 3))
    own = 0.002**2 * np.eye(3)
    runs, with_oil = points(values, own), measured(temperature[:, None], "oil")
    found = adjustment(runs[:39], with_oil[:39], [OIL], scatter=0.005)
    moved = np.array([found.adjusted(*one).value for one in zip(runs, with_oil, strict=True)])
    assert np.all(np.std(moved - values + season, axis=0) < np.std(season) / 4)
    assert np.all(np.std(moved, axis=0) < 0.6 * np.std(values, axis=0))


def test_nothing_is_adjusted_where_nothing_is_known() -> None:
    values, own = np.zeros((5, 3)), 1e-4 * np.eye(3)
    oil = measured(np.linspace(50.0, 60.0, 5)[:, None], "oil")
    point = Point(NAMES, np.ones(3), own)
    nobody: list[Measured] = [{} for _ in range(5)]
    without: list[Measured] = [{"oil": None}, *nobody[1:]]
    few = FEWEST_RUNS - 1
    for found in (
        adjustment(points(values, own), oil, []),
        adjustment(points(values, own), nobody, [OIL]),
        adjustment(points(values, own), without, [OIL]),
        adjustment(points(values[:few], own), oil[:few], [OIL]),
        adjustment([], [], [OIL]),
    ):
        assert found.adjusted(point, {"oil": 90.0}) is point


def test_runs_without_a_condition_and_conditions_without_runs_are_left_out() -> None:
    rng = np.random.default_rng(4)
    table = rng.normal([55.0, 70.0], [5.0, 15.0], (6, 2))
    values, own = rng.normal(0.0, 0.02, (6, 3)), 1e-4 * np.eye(3)
    whole = measured(table, "oil", "load")
    seldom = [{**one, "load": None if run > 2 else one["load"]} for run, one in enumerate(whole)]
    found = adjustment(points(values, own), seldom, [OIL, LOAD])
    assert found.conditions == ("oil",)
    assert found.slope == pytest.approx(adjustment(points(values, own), whole, [OIL]).slope)
    once = [{**one, "load": None if run == 0 else one["load"]} for run, one in enumerate(whole)]
    found = adjustment(points(values, own), once, [OIL, LOAD])
    assert found.slope == pytest.approx(adjustment(points(values[1:], own), whole[1:], [OIL, LOAD]).slope)


def test_only_what_was_regressed_moves() -> None:
    """A new run without a reading is taken at the mean; unbalances and parameters that the baseline lacks stay."""
    rng = np.random.default_rng(5)
    temperature = rng.normal(55.0, 5.0, (6, 1))
    values, own = -0.002 * (temperature - 55.0) + rng.normal(0.0, 1e-3, (6, 3)), 1e-6 * np.eye(3) + 1e-6
    found = adjustment(points(values, own), measured(temperature, "oil"), [OIL])
    names = ("disc.D1.unbalance.real", NAMES[2], "bearing.B9.kxx", NAMES[0])
    point = Point(names, np.arange(4.0), 1e-4 * np.eye(4))
    assert found.adjusted(point, {}) is point
    assert found.adjusted(point, {"oil": None, "load": 3.0}) is point
    moved = found.adjusted(point, {"oil": 65.0})
    assert (moved.value != point.value).tolist() == [False, True, False, True]
    same = moved.covariance == point.covariance
    assert same.tolist() == [[True] * 4, [True, False, True, False], [True] * 4, [True, False, True, False]]
    assert point.value.tolist() == [0.0, 1.0, 2.0, 3.0]


@pytest.mark.parametrize(
    ("unit", "given", "usual"), [("K", None, 10.0), ("%", None, 20.0), ("bar", 3.0, 3.0), ("degC", 5.0, 5.0)]
)
def test_a_condition_that_hardly_changed_leaves_the_prior(unit: str, given: float | None, usual: float) -> None:
    condition = Condition(name="x", unit=unit, usual_change=given)
    table = measured(np.full((5, 1), 7.0), "x")
    found = adjustment(points(np.zeros((5, 3)), 1e-4 * np.eye(3)), table, [condition])
    moved = found.adjusted(Point(NAMES, np.zeros(3), np.zeros((3, 3))), {"x": 7.0 + usual})
    assert moved.covariance == pytest.approx(0.01**2 * np.eye(3), abs=1e-12)


def test_a_unit_that_says_nothing_is_measured_by_the_baseline() -> None:
    flat = adjustment(
        points(np.zeros((5, 3)), 1e-4 * np.eye(3)), measured(np.full((5, 1), 7.0), "x"), [Condition(name="x", unit="bar")]
    )
    assert flat.conditions == ()
    table = np.array([1.0, 2.0, 3.0, 4.0, 5.0])[:, None]
    one, other = (
        adjustment(
            points(0.01 * table * np.ones(3), 1e-4 * np.eye(3)),
            measured(factor * table, "x"),
            [Condition(name="x", unit=unit)],
        )
        for factor, unit in ((1.0, "bar"), (100.0, "kPa"))
    )
    assert one.slope == pytest.approx(100.0 * other.slope)


def test_as_many_conditions_as_runs() -> None:
    with pytest.raises(ValueError, match="1 sets of conditions for 2 runs"):
        adjustment(points(np.zeros((2, 3)), np.eye(3)), [{}], [OIL])
