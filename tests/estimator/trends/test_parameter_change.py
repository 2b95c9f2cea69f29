"""Tests what changed between two identifications, against closed forms and by chance."""

import numpy as np
import pytest
import scipy.stats

from estimator.trends.parameter_change import Values, element_changes, parameter_changes

NAMES = ("bearing.B1.kxx", "bearing.B1.kxy", "coupling.C1.kxx")


def values(point: list[float], covariance: np.ndarray) -> Values:
    return Values(NAMES, np.array(point), covariance)


def test_a_change_is_measured_in_the_errors_of_both() -> None:
    first = values([np.log(2e6), 1e4, np.log(5e6)], np.diag([0.03**2, 300.0**2, 0.01**2]))
    second = values([np.log(2.2e6), 1.5e4, np.log(5e6)], np.diag([0.04**2, 400.0**2, 0.01**2]))
    direct, cross, same = parameter_changes(first, second)
    assert (direct.first, direct.second) == pytest.approx((2e6, 2.2e6))
    assert direct.relative == pytest.approx(0.1)
    assert direct.sigma == pytest.approx(np.log(1.1) / 0.05)
    assert cross.relative is None
    assert cross.sigma == pytest.approx(10.0)
    assert (same.relative, same.sigma) == pytest.approx((0.0, 0.0))


def test_an_element_is_judged_with_its_correlations() -> None:
    covariance = np.array([[1.0, 0.9, 0.0], [0.9, 1.0, 0.0], [0.0, 0.0, 4.0]])
    first, second = values([0.0, 0.0, 0.0], covariance), values([1.0, 1.0, 2.0], covariance)
    bearing, coupling = element_changes(first, second)
    change = np.array([1.0, 1.0])
    assert bearing.element == "bearing.B1"
    assert bearing.distance == pytest.approx(change @ np.linalg.solve(2 * covariance[:2, :2], change))
    assert (bearing.degrees_of_freedom, coupling.degrees_of_freedom) == (2, 1)
    assert coupling.distance == pytest.approx(0.5)
    assert coupling.probability == pytest.approx(scipy.stats.chi2.sf(0.5, 1))


def test_what_is_known_exactly_takes_no_part() -> None:
    exact = values([0.0, 0.0, 0.0], np.diag([0.0, 1.0, 0.0]))
    (bearing,) = element_changes(exact, exact)
    assert (bearing.element, bearing.degrees_of_freedom, bearing.distance) == ("bearing.B1", 1, 0.0)


def test_while_nothing_changes_the_probability_is_even() -> None:
    rng = np.random.default_rng(3)
    half = rng.standard_normal((3, 3))
    covariance = half @ half.T
    found = []
    for _ in range(400):
        draws = rng.multivariate_normal(np.zeros(3), covariance, 2)
        one, other = (values(draw.tolist(), covariance) for draw in draws)
        found.append(element_changes(one, other)[0].probability)
    assert scipy.stats.kstest(found, "uniform").pvalue > 0.01
