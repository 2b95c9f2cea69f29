"""Trend tests: how often their charts cry wolf with a small baseline, since when there is a step, when a limit comes."""

import math

import numpy as np
import pytest
import scipy.stats

from estimator.trends import control_charts
from estimator.trends.between_run_scatter import PRIOR_WEIGHT, STIFFNESS_SCATTER
from estimator.trends.deviations import Whitening, deviations
from estimator.trends.drift import TimeToLimit
from estimator.trends.parameter_vector import Point
from estimator.trends.trend_tests import (
    CUSUM_REFERENCE,
    EWMA_WEIGHT,
    LONGEST_DRIFT,
    RUN_LENGTH,
    DatedPoint,
    TrendTest,
    creep_limit,
    distance_trends,
    step_limit,
    time_to_change,
    trend_tests,
)
from tests.estimator.trends.chart_limits import cusum_limit, ewma_limit

NAME = "coupling.C1.kxx"
NAMES = (NAME, "coupling.C1.kyy", "bearing.B2.kxx")
RUNS = 5
OWN = 0.002


def point(change: float = 0.0, names: tuple[str, ...] = NAMES) -> Point:
    """Both stiffnesses of the coupling changed, the bearing as it was."""
    moved = [math.log(1e7) + change * name.startswith("coupling") for name in names]
    return Point(names, np.array(moved), OWN**2 * np.eye(len(names)))


def readings(changes: list[float]) -> list[DatedPoint]:
    """A run a week, the first after ten weeks."""
    return [DatedPoint(10.0 + week, point(change)) for week, change in enumerate(changes)]


def of(name: str, tests: tuple[TrendTest, ...]) -> TrendTest:
    (found,) = (one for one in tests if one.name == name)
    return found


BASELINE = [point(0.01 * part) for part in (-1.0, -0.5, 0.0, 0.5, 1.0)]


def test_a_step_is_found_with_the_run_in_which_it_began() -> None:
    found = of(NAME, trend_tests(BASELINE, readings([0.0, -0.005, 0.005, 0.1, 0.1])))
    assert found.step_up.passed
    assert found.step_up.began == 13.0
    assert found.step_down is not None
    assert (found.step_down.passed, found.step_down.began) == (False, None)
    assert (found.step_up.runs, found.step_down.runs) == (2, None)
    assert found.newest == pytest.approx(0.1)
    assert found.runs == 5
    down = of(NAME, trend_tests(BASELINE, readings([0.0, -0.1, -0.1]))).step_down
    assert down is not None
    assert (down.passed, down.began) == (True, 11.0)


def test_charts_are_those_of_the_deviations() -> None:
    changes = [0.0, 0.02, 0.01, 0.03]
    found = of(NAME, trend_tests(BASELINE, readings(changes)))
    white = Whitening.of(BASELINE, [NAME])
    deviation = np.array(changes) / math.sqrt(OWN**2 + white.scatter[0])
    assert found.step_up.value == pytest.approx(control_charts.cusum(deviation, reference=CUSUM_REFERENCE)[-1])
    assert found.creep.value == pytest.approx(control_charts.ewma(deviation, weight=EWMA_WEIGHT)[-1])


def test_the_element_moves_as_far_as_its_distance_says() -> None:
    changes = [0.0, 0.01, 0.1, 0.1]
    found = distance_trends(BASELINE, readings(changes))
    assert [one.name for one in found] == ["coupling.C1", "bearing.B2"]
    now = deviations(BASELINE, point(0.1))
    assert of("coupling.C1", found).newest == pytest.approx(
        next(e.distance for e in now.elements if e.element == "coupling.C1")
    )
    assert of("coupling.C1", found).step_up.began == 12.0
    assert not of("bearing.B2", found).step_up.passed
    assert of("coupling.C1", found).step_down is None


def test_a_run_that_does_not_determine_a_parameter_is_passed_over() -> None:
    some = readings([0.0, 0.0, 0.1, 0.1])
    some[1] = DatedPoint(11.0, point(0.0, NAMES[1:]))
    assert of(NAME, trend_tests(BASELINE, some)).runs == 3
    assert of("coupling.C1", distance_trends(BASELINE, some)).runs == 3
    assert of("bearing.B2", distance_trends(BASELINE, some)).runs == 4
    less = [*BASELINE[:-1], point(0.0, NAMES[1:])]
    assert [one.name for one in trend_tests(less, some)] == ["coupling.C1.kyy", "bearing.B2.kxx"]
    assert trend_tests(BASELINE, []) == distance_trends(BASELINE, []) == ()


def test_drift_and_the_time_until_a_change_is_reached() -> None:
    """ln k grows by 1 % a week and stands at 9 %: 20 % is ln 1.2 - 0.09 away."""
    found = of(NAME, trend_tests(BASELINE, readings([0.01 * week for week in range(10)])))
    assert found.drift is not None
    assert found.drift.slope == pytest.approx(0.01)
    ahead = time_to_change(found.drift, 0.2, logarithmic=True)
    assert ahead.expected == pytest.approx((math.log(1.2) - 0.09) / 0.01)
    assert time_to_change(found.drift, 0.2, logarithmic=False).expected == pytest.approx(11.0)
    falling = of(NAME, trend_tests(BASELINE, readings([-0.01 * week for week in range(10)]))).drift
    assert falling is not None
    assert time_to_change(falling, 0.2, logarithmic=True).expected == pytest.approx((-math.log(0.8) - 0.09) / 0.01)
    assert time_to_change(falling, 1.0, logarithmic=True) == TimeToLimit(None, None, None)
    assert of(NAME, trend_tests(BASELINE, readings([0.0] * 3))).drift is None


def test_a_long_history_is_tested_by_its_newest_part() -> None:
    flat = of(NAME, trend_tests(BASELINE, readings([0.01 * week for week in range(30)] + [0.3] * LONGEST_DRIFT)))
    assert flat.drift is not None
    assert flat.drift.slope == 0.0


def test_small_baselines_need_wider_limits() -> None:
    """With a baseline that is known exactly they are the textbook's."""
    runs, freedom = RUNS, PRIOR_WEIGHT + RUNS - 1
    assert step_limit(runs=runs, degrees_of_freedom=freedom) > step_limit(runs=4 * runs, degrees_of_freedom=4 * freedom)
    assert creep_limit(runs=runs, degrees_of_freedom=freedom) > creep_limit(runs=4 * runs, degrees_of_freedom=4 * freedom)
    exact = cusum_limit(reference=CUSUM_REFERENCE, run_length=RUN_LENGTH)
    assert step_limit(runs=10**6, degrees_of_freedom=1e6) == pytest.approx(exact, rel=0.01)
    exact = ewma_limit(weight=EWMA_WEIGHT, run_length=RUN_LENGTH)
    assert creep_limit(runs=10**6, degrees_of_freedom=1e6) == pytest.approx(exact, rel=0.01)


def test_false_alarms_come_as_rarely_as_stated_though_the_baseline_is_small() -> None:
    """1,500 machines of five runs and unknown scatter, two years each; charts begin anew after an alarm. The machines differ
    far more than chance does, so a quarter either way is taken. The textbook's limits
    would give more than five times as many."""
    rng = np.random.default_rng(3)
    count, weeks = 1500, 104
    freedom = PRIOR_WEIGHT + RUNS - 1
    true = STIFFNESS_SCATTER * np.sqrt(PRIOR_WEIGHT / rng.chisquare(PRIOR_WEIGHT, count))
    runs = true[:, None] * rng.standard_normal((count, RUNS + weeks))
    centre = runs[:, :RUNS].mean(axis=1)
    seen = np.sum((runs[:, :RUNS] - centre[:, None]) ** 2, axis=1)
    used = np.sqrt((PRIOR_WEIGHT * STIFFNESS_SCATTER**2 + seen) / freedom)
    deviation = (runs[:, RUNS:] - centre[:, None]) / used[:, None]

    def steps(limit: float) -> float:
        level, alarms = np.zeros(count), 0
        for value in deviation.T:
            level = np.maximum(0.0, level + value - CUSUM_REFERENCE)
            alarms += int(np.count_nonzero(level > limit))
            level[level > limit] = 0.0
        return count * weeks / alarms

    def creeps(limit: float) -> float:
        mean, alarms = np.zeros(count), 0
        for value in deviation.T:
            mean += EWMA_WEIGHT * (value - mean)
            passed = np.abs(mean) > limit * math.sqrt(EWMA_WEIGHT / (2 - EWMA_WEIGHT))
            alarms += int(np.count_nonzero(passed))
            mean[passed] = 0.0
        return count * weeks / alarms

    assert 0.75 < steps(step_limit(runs=RUNS, degrees_of_freedom=freedom)) / RUN_LENGTH < 1.33
    assert 0.75 < creeps(creep_limit(runs=RUNS, degrees_of_freedom=freedom)) / RUN_LENGTH < 1.33
    textbook = cusum_limit(reference=CUSUM_REFERENCE, run_length=RUN_LENGTH)
    assert steps(textbook) < RUN_LENGTH / 5


def test_distances_pass_their_limit_no_oftener_than_stated() -> None:
    """Standardised through their chance they are normal; what baselines have in common makes them rarer, not oftener."""
    rng = np.random.default_rng(4)
    alarms, count, weeks = 0, 150, 60
    names = NAMES[:2]
    for _ in range(count):
        true = STIFFNESS_SCATTER * np.sqrt(PRIOR_WEIGHT / rng.chisquare(PRIOR_WEIGHT, 2))
        points = [Point(names, true * rng.standard_normal(2), OWN**2 * 1e-6 * np.eye(2)) for _ in range(RUNS + weeks)]
        (found,) = distance_trends(points[:RUNS], [DatedPoint(float(w), one) for w, one in enumerate(points[RUNS:])])
        alarms += found.step_up.passed
    # Passed at the end of 60 weeks is less than passed once in them.
    assert scipy.stats.binom.sf(alarms - 1, count, weeks / RUN_LENGTH) > 0.01


def test_readings_must_ascend() -> None:
    with pytest.raises(ValueError, match="ascend"):
        trend_tests(BASELINE, [DatedPoint(1.0, point()), DatedPoint(1.0, point())])
    with pytest.raises(ValueError, match="ascend"):
        distance_trends(BASELINE, [DatedPoint(2.0, point()), DatedPoint(1.0, point())])
