"""Run-to-run scatter: what is expected of each parameter, how much a baseline teaches, and how well Student's t then holds."""

import math

import numpy as np
import pytest
import scipy.stats
from hypothesis import given
from hypothesis import strategies as st

from estimator.trends.between_run_scatter import (
    DAMPING_SCATTER,
    EXCITATION_SCATTER,
    PRIOR_WEIGHT,
    STIFFNESS_SCATTER,
    between_run_scatter,
    expected_scatter,
    sizes,
)
from estimator.trends.parameter_vector import Point
from tests.plant import few_examples

NAMES = (
    "bearing.B1.kxx",
    "bearing.B1.kxy",
    "bearing.B1.kyy",
    "bearing.B1.cxx",
    "bearing.B1.cxy@1500rpm",
    "bearing.B1.cxx@1500rpm",
    "coupling.C1.k_phix",
    "coupling.C1.k_phixy",
    "seal.S1.kxy",
    "disc.D1.unbalance.real",
    "disc.D1.unbalance.imaginary",
    "disc.D2.unbalance.real",
    "disc.D2.unbalance.imaginary",
    "probe.P1.gain.real",
)
CENTRE = np.array(
    [
        *(math.log(1e6), 3e4, math.log(4e6), math.log(2e3), 5.0, math.log(500.0)),
        *(math.log(2e4), 100.0, -7e3),
        *(3e-3, 4e-3, 0.0, 1e-4, 0.01),
    ]
)
RUNS = 5


def points(values: np.ndarray[tuple[int, int], np.dtype[np.float64]], own: float = 0.0) -> list[Point]:
    """A baseline of two stiffnesses."""
    return [Point(("bearing.B1.kxx", "bearing.B1.kyy"), value, own**2 * np.eye(2)) for value in values]


def test_each_parameter_is_measured_by_what_is_beside_it() -> None:
    found = dict(zip(NAMES, sizes(NAMES, CENTRE), strict=True))
    assert found["bearing.B1.kxx"] == found["probe.P1.gain.real"] == 1.0
    assert found["bearing.B1.kxy"] == pytest.approx(2e6)  # geometric mean of kxx and kyy
    assert found["bearing.B1.cxy@1500rpm"] == pytest.approx(500.0)  # only cxx is known there
    assert found["coupling.C1.k_phixy"] == pytest.approx(2e4)
    assert found["seal.S1.kxy"] == pytest.approx(7e3)  # nothing is known beside it
    assert found["disc.D1.unbalance.real"] == found["disc.D1.unbalance.imaginary"] == pytest.approx(5e-3)
    assert found["disc.D2.unbalance.imaginary"] == pytest.approx(5e-3 / 3)  # small: by the largest unbalance


def test_stiffness_damping_and_unbalance_are_expected_to_scatter_differently() -> None:
    found = dict(zip(NAMES, expected_scatter(NAMES), strict=True))
    assert found["bearing.B1.kxx"] == found["coupling.C1.k_phixy"] == found["probe.P1.gain.real"] == STIFFNESS_SCATTER
    assert found["bearing.B1.cxx"] == found["bearing.B1.cxy@1500rpm"] == DAMPING_SCATTER
    assert found["disc.D1.unbalance.real"] == EXCITATION_SCATTER


def test_one_run_leaves_the_expectation_as_it_is() -> None:
    (one,) = points(np.zeros((1, 2)))
    found = between_run_scatter([one])
    assert found.variance == pytest.approx([STIFFNESS_SCATTER**2] * 2)
    assert found.degrees_of_freedom == pytest.approx([PRIOR_WEIGHT] * 2)


def test_runs_whose_errors_hide_the_scatter_count_for_less() -> None:
    """Own errors as large as the expected scatter: a difference of two equal variances is known a quarter as well."""
    values = 0.02 * np.random.default_rng(6).standard_normal((RUNS, 2))
    assert between_run_scatter(points(values)).degrees_of_freedom == pytest.approx([PRIOR_WEIGHT + RUNS - 1] * 2)
    hidden = between_run_scatter(points(values, own=STIFFNESS_SCATTER)).degrees_of_freedom
    assert hidden == pytest.approx([PRIOR_WEIGHT + (RUNS - 1) / 4] * 2)


def test_many_runs_outweigh_the_expectation() -> None:
    values = 0.03 * np.random.default_rng(1).standard_normal((2000, 2))
    assert np.sqrt(between_run_scatter(points(values)).variance) == pytest.approx([0.03, 0.03], rel=0.06)


def test_what_the_fits_own_errors_explain_is_no_scatter() -> None:
    """Own errors of 2 % and a scatter of 3 %: over 5,000 runs their difference outweighs the expected 1 % by 20 to 1."""
    rng = np.random.default_rng(2)
    values = math.hypot(0.02, 0.03) * rng.standard_normal((5000, 2))
    expected = math.sqrt((0.03**2 * 4999 / 25 + STIFFNESS_SCATTER**2 * PRIOR_WEIGHT) / (4999 / 25 + PRIOR_WEIGHT))
    assert np.sqrt(between_run_scatter(points(values, own=0.02)).variance) == pytest.approx([expected] * 2, rel=0.04)


@few_examples
@given(order=st.permutations(range(RUNS)))
def test_the_order_of_the_runs_does_not_matter(order: list[int]) -> None:
    values = 0.02 * np.random.default_rng(3).standard_normal((RUNS, 2))
    straight, shuffled = between_run_scatter(points(values)), between_run_scatter(points(values[order]))
    assert shuffled.variance == pytest.approx(straight.variance, rel=1e-12)


@few_examples
@given(order=st.permutations(range(len(NAMES))))
def test_the_order_of_the_parameters_does_not_matter(order: list[int]) -> None:
    shuffled = [NAMES[i] for i in order]
    assert sizes(shuffled, CENTRE[order]) == pytest.approx(sizes(NAMES, CENTRE)[order])


def test_a_deviation_follows_students_t_when_machines_scatter_as_believed() -> None:
    """Machines drawn from the prior itself, five runs each: p-values of a sixth run are even. Kolmogorov and Smirnov's
    distance of 4,000 even draws exceeds 0.03 once in a thousand times."""
    rng = np.random.default_rng(4)
    chances = []
    for _ in range(4000):
        scatter = STIFFNESS_SCATTER * math.sqrt(PRIOR_WEIGHT / rng.chisquare(PRIOR_WEIGHT))
        runs = scatter * rng.standard_normal((RUNS + 1, 2))
        found = between_run_scatter(points(runs[:RUNS]))
        error = math.sqrt(found.variance[0] * (1 + 1 / RUNS))
        chances.append(scipy.stats.t.sf((runs[RUNS, 0] - runs[:RUNS, 0].mean()) / error, found.degrees_of_freedom[0]))
    assert scipy.stats.kstest(chances, "uniform").statistic < 0.03


def test_a_baseline_must_be_one() -> None:
    with pytest.raises(ValueError, match="at least one"):
        between_run_scatter([])
    one = Point(("bearing.B1.kxx",), np.zeros(1), np.eye(1))
    other = Point(("bearing.B2.kxx",), np.zeros(1), np.eye(1))
    with pytest.raises(ValueError, match="same parameters"):
        between_run_scatter([one, other])
