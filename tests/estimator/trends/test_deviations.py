"""Deviations from a baseline: sizes against closed forms, chances against simulation, laws that hold whatever the data."""

import math
from functools import cache

import numpy as np
import pytest
import scipy.stats
from hypothesis import given
from hypothesis import strategies as st

from estimator.trends.between_run_scatter import PRIOR_WEIGHT, expected_scatter, sizes
from estimator.trends.deviations import Deviations, chance_of_distance, deviations
from estimator.trends.parameter_vector import Point
from tests.plant import few_examples

NAMES = (
    *(f"bearing.B1.{name}" for name in ("kxx", "kxy", "kyx", "kyy", "cxx", "cyy")),
    *(f"coupling.C1.{name}" for name in ("kxx", "kyy")),
    "disc.D1.unbalance.real",
    "disc.D1.unbalance.imaginary",
)
CENTRE = np.array([*np.log([1e6]), 1e5, -1e5, *np.log([4e6, 2e3, 2e3, 1e7, 1e7]), 3e-3, 4e-3])
SIZE = sizes(NAMES, CENTRE)
RUNS = 5
DRAWS = 1500


def point(change: dict[str, float] | None = None, *, own: float = 0.005) -> Point:
    """The machine with some changes, each part of its parameter's size."""
    moved = np.array([(change or {}).get(name, 0.0) for name in NAMES])
    return Point(NAMES, CENTRE + moved * SIZE, np.diag((own * SIZE) ** 2))


def found(change: dict[str, float], *, own: float = 0.005) -> Deviations:
    return deviations([point(own=own)] * RUNS, point(change, own=own))


def test_changes_are_reported_in_the_parameters_own_sizes() -> None:
    change = {"bearing.B1.kxx": math.log(1.2), "bearing.B1.kxy": 0.05, "disc.D1.unbalance.imaginary": 0.4}
    by_name = {one.name: one for one in found(change).parameters}
    assert by_name["bearing.B1.kxx"].change == pytest.approx(0.2)
    assert by_name["bearing.B1.kxy"].change == pytest.approx(0.05)  # 1e5 of a geometric mean of 2e6
    assert by_name["coupling.C1.kxx"].change == pytest.approx(0.0)
    unbalance = by_name["disc.D1.unbalance"]
    assert unbalance.change == pytest.approx(0.4)
    assert unbalance.vector == pytest.approx(2e-3j)
    assert "disc.D1.unbalance.real" not in by_name


def scatter(name: str, *, own: float) -> tuple[float, float]:
    """Run-to-run variance that five equal runs leave of what was expected, and its degrees of freedom."""
    (prior,) = expected_scatter([name]) ** 2
    weight = (RUNS - 1) * (prior / (prior + own**2)) ** 2
    return prior * PRIOR_WEIGHT / (PRIOR_WEIGHT + weight), PRIOR_WEIGHT + weight


@pytest.mark.parametrize(("name", "change"), [("bearing.B1.kxx", -0.03), ("bearing.B1.cxx", 0.1)])
@pytest.mark.parametrize("own", [0.0001, 0.005, 0.05])
def test_sigma_is_the_change_over_its_standard_error(name: str, change: float, own: float) -> None:
    (one,) = (each for each in found({name: change}, own=own).parameters if each.name == name)
    variance, freedom = scatter(name, own=own)
    error = math.sqrt((own**2 + variance) * (1 + 1 / RUNS))
    assert one.sigma == pytest.approx(change / error)
    assert one.degrees_of_freedom == pytest.approx(freedom * (variance + own**2) / variance)
    assert one.probability == pytest.approx(2 * scipy.stats.t.sf(abs(one.sigma), one.degrees_of_freedom))
    half = error * scipy.stats.t.ppf(0.975, one.degrees_of_freedom)
    assert (one.lower, one.upper) == pytest.approx((math.expm1(change - half), math.expm1(change + half)))


def test_what_is_not_determined_everywhere_is_not_compared() -> None:
    less = [point()] * (RUNS - 1) + [point().of(NAMES[1:])]
    assert "bearing.B1.kxx" not in {one.name for one in deviations(less, point()).parameters}
    assert deviations([point()], Point((), np.zeros(0), np.zeros((0, 0)))) == Deviations((), ())
    with pytest.raises(ValueError, match="at least one"):
        deviations([], point())


def test_only_the_element_that_moved_is_far() -> None:
    far = {one.element: one for one in found({"coupling.C1.kxx": 0.1, "coupling.C1.kyy": 0.1}).elements}
    assert far["coupling.C1"].probability < 1e-6
    assert far["bearing.B1"].distance == far["disc.D1"].distance == 0.0
    assert far["bearing.B1"].probability == 1.0
    assert [len(one.names) for one in far.values()] == [6, 2, 2]


def test_correlated_errors_make_a_common_change_likelier_than_an_opposite_one() -> None:
    """Errors of 5 % that two coefficients share: both 5 % up is one σ, one up and one down is many."""
    names = NAMES[6:8]
    shared = 0.05**2 * (np.ones((2, 2)) + 1e-4 * np.eye(2))

    def distance(*change: float) -> float:
        return (
            deviations([Point(names, np.zeros(2), shared)] * RUNS, Point(names, np.array(change), shared)).elements[0].distance
        )

    assert distance(0.05, 0.05) < 1.0 < 3.0 < distance(0.05, -0.05)


@few_examples
@given(order=st.permutations(range(len(NAMES))), runs=st.permutations(range(RUNS)), seed=st.integers(0, 1000))
def test_the_order_of_parameters_and_runs_does_not_matter(order: list[int], runs: list[int], seed: int) -> None:
    rng = np.random.default_rng(seed)
    whole = [Point(NAMES, CENTRE + 0.02 * SIZE * rng.standard_normal(SIZE.size), point().covariance) for _ in range(RUNS + 1)]
    shuffled = [one.of([NAMES[i] for i in order]) for one in whole]
    straight = deviations(whole[:RUNS], whole[RUNS])
    other = deviations([shuffled[i] for i in runs], shuffled[RUNS])
    for one in straight.elements:
        (same,) = (each for each in other.elements if each.element == one.element)
        assert same.distance == pytest.approx(one.distance, rel=1e-9)
        assert same.probability == pytest.approx(one.probability, rel=1e-9)
    assert {one.name for one in other.parameters} == {one.name for one in straight.parameters}


@few_examples
@given(
    direction=st.lists(st.floats(-1, 1), min_size=6, max_size=6).filter(lambda d: np.linalg.norm(d) > 0.1),
    amount=st.floats(0.001, 0.5),
    grown=st.floats(1.01, 5.0),
)
def test_a_larger_change_is_farther_and_less_likely(direction: list[float], amount: float, grown: float) -> None:
    def moved(by: float) -> tuple[float, float]:
        change = {name: by * amount * part for name, part in zip(NAMES, direction, strict=False)}
        (one,) = (each for each in found(change).elements if each.element == "bearing.B1")
        return one.distance, -one.probability

    assert moved(grown) >= moved(1.0)
    assert moved(grown)[0] == pytest.approx(grown * moved(1.0)[0])


@cache
def chances(own: float) -> tuple[list[float], list[float]]:
    """p-values of a bearing's stiffness and of the whole bearing, of machines whose scatter is drawn from what is believed of
    it, in a sixth run like the five before. own: the fits' errors, correlated, part of each size."""
    rng = np.random.default_rng(11)
    names, size = NAMES[:6], SIZE[:6]
    errors = own**2 * (0.4 * np.eye(6) + 0.6)
    alone, together = [], []
    for _ in range(DRAWS):
        scattered = expected_scatter(names) * np.sqrt(PRIOR_WEIGHT / rng.chisquare(PRIOR_WEIGHT, 6))
        moved = scattered * rng.standard_normal((RUNS + 1, 6)) + rng.multivariate_normal(np.zeros(6), errors, RUNS + 1)
        runs = [Point(names, CENTRE[:6] + one * size, errors * np.outer(size, size)) for one in moved]
        result = deviations(runs[:RUNS], runs[RUNS])
        alone.append(result.parameters[0].probability)
        together.append(result.elements[0].probability)
    return alone, together


@pytest.mark.parametrize("own", [0.001, 0.01])
@pytest.mark.parametrize("which", [0, 1], ids=["stiffness", "bearing"])
def test_chances_are_even_while_nothing_changes(which: int, own: float) -> None:
    """Kolmogorov and Smirnov's distance of 1,500 even draws exceeds 0.05 once in a thousand times."""
    drawn = np.array(chances(own)[which])
    assert scipy.stats.kstest(drawn, "uniform").statistic < 0.05
    assert 0.004 < np.mean(drawn <= 0.01) < 0.018


@pytest.mark.parametrize("size", [1, 2, 8, 14])
def test_the_chance_of_a_distance_is_that_of_a_sum_of_squared_t_values(size: int) -> None:
    """Within 7 % to one in a hundred; beyond, the sum's tail is heavier than it is here by up to a third."""
    sums = np.sum(np.random.default_rng(5).standard_t(14, (300_000, size)) ** 2, axis=1)
    found = [
        chance_of_distance(float(np.quantile(sums, 1 - chance)), size=size, degrees_of_freedom=14.0) / chance
        for chance in (0.5, 0.05, 0.01, 0.001)
    ]
    assert found[:3] == pytest.approx([1.0] * 3, rel=0.07)
    assert 0.65 < found[3] < 1.25


def test_with_scatter_that_is_known_the_distance_follows_chi_square() -> None:
    for size in (1, 5):
        chance = chance_of_distance(9.0, size=size, degrees_of_freedom=math.inf)
        assert chance == pytest.approx(scipy.stats.chi2.sf(9.0, size), rel=1e-3)
