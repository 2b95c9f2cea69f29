"""The common shift against a baseline: how often it cries wolf, how surely it sees, and how it weighs what it is given."""

from functools import cache

import numpy as np
import pytest
import scipy.stats

from estimator.baseline import PRIOR_SCATTER, PRIOR_WEIGHT, CommonShift, Point, common_shift

NAMES = ("coupling.C1.kxx", "coupling.C1.kyy", "bearing.B2.kxx", "bearing.B2.kyy")
DRAWS = 5_000
RUNS = 5
CHANCE = 0.01


@cache
def drawn(*, own: float, scatter: float, shift: float = 0.0, draws: int = DRAWS) -> tuple[CommonShift, ...]:
    """What baselines of some runs say of one more run of a machine that scatters from run to run and has shifted.

    own: the estimates' errors; one coefficient is known half as well as the others, and all are somewhat correlated.
    """
    rng = np.random.default_rng(7)
    size = own * np.array([1.0, 1.0, 1.0, 2.0])
    errors = np.outer(size, size) * (0.3 + 0.7 * np.eye(4))
    values = scatter * rng.standard_normal((draws, RUNS + 1, 4))
    values += rng.standard_normal(values.shape) @ np.linalg.cholesky(errors).T
    values[:, RUNS] += shift
    points = ([Point(NAMES, value, errors) for value in runs] for runs in values)
    return tuple(common_shift(runs[:RUNS], runs[RUNS], NAMES) for runs in points)


def false_alarms(*, own: float, scatter: float) -> float:
    """Part of the draws called a shift at `CHANCE` while nothing has changed."""
    return float(np.mean([one.probability <= CHANCE for one in drawn(own=own, scatter=scatter)]))


@pytest.mark.parametrize("own", [0.002, 0.02])
def test_false_alarms_come_as_often_as_stated(own: float) -> None:
    """With the scatter that the prior expects. The t distribution is an approximation on the safe side, as part of the
    scatter is known beforehand: 0.4 to 1.3 % are taken for 1 %, three standard errors of 5,000 draws being 0.42 %."""
    assert 0.004 < false_alarms(own=own, scatter=PRIOR_SCATTER) < 0.013


def test_probabilities_are_spread_evenly_while_nothing_changes() -> None:
    """A Kolmogorov-Smirnov distance of 0.03: even draws exceed it once in 4,000 times, the approximation's share included."""
    probabilities = [one.probability for one in drawn(own=0.002, scatter=PRIOR_SCATTER)]
    assert scipy.stats.kstest(probabilities, "uniform").statistic < 0.03


def test_a_machine_that_scatters_less_than_expected_gives_fewer_false_alarms() -> None:
    assert false_alarms(own=0.002, scatter=PRIOR_SCATTER / 2) < 0.004


def test_a_machine_that_scatters_twice_as_much_is_learnt_from_the_baseline() -> None:
    """Five runs against a prior worth ten: false alarms grow, yet stay well below the 12 % of the prior taken alone."""
    alone = scipy.stats.norm.sf(scipy.stats.norm.isf(CHANCE) / 2)
    assert false_alarms(own=0.002, scatter=2 * PRIOR_SCATTER) < 0.6 * alone


def test_a_shift_of_ten_per_cent_is_seen() -> None:
    """Its size without bias (three standard errors of the mean), and at 1e-4 in more than nine of ten identifications."""
    shifted = drawn(own=0.005, scatter=PRIOR_SCATTER, shift=float(np.log(1.1)), draws=500)
    sizes = np.array([one.shift for one in shifted])
    assert abs(sizes.mean() - np.log(1.1)) < 3 * sizes.std() / np.sqrt(len(sizes))
    assert np.mean([one.probability <= 1e-4 for one in shifted]) > 0.9


def test_the_standard_error_is_that_of_the_shift() -> None:
    """Within 5 %: five standard errors of a standard deviation from 5,000 draws."""
    shifts = drawn(own=0.002, scatter=PRIOR_SCATTER)
    stated = np.sqrt(np.mean([one.standard_error**2 for one in shifts]))
    assert np.std([one.shift for one in shifts]) == pytest.approx(stated, rel=0.05)


def test_a_shift_downwards_is_no_alarm() -> None:
    down = drawn(own=0.005, scatter=PRIOR_SCATTER, shift=-0.1, draws=100)
    assert max(one.statistic for one in down) < 0
    assert min(one.probability for one in down) > 0.5


def exact(values: list[float], own: float = 1e-3) -> Point:
    return Point(NAMES, np.array(values), own**2 * np.eye(4))


def test_equal_runs_leave_the_scatter_to_the_prior() -> None:
    """No excess: the prior's scatter, shrunk by the baseline's degrees of freedom."""
    one = common_shift([exact([0.0] * 4)] * RUNS, exact([0.1] * 4), NAMES)
    assert one.shift == pytest.approx(0.1)
    assert one.degrees_of_freedom == PRIOR_WEIGHT + RUNS - 1
    assert one.scatter == pytest.approx(PRIOR_SCATTER / 2 * np.sqrt(PRIOR_WEIGHT / one.degrees_of_freedom))  # mean of four


def test_a_parameter_known_badly_weighs_little() -> None:
    errors = np.diag([1e-3, 1e-3, 1e-3, 1.0]) ** 2
    baseline = [Point(NAMES, np.zeros(4), errors)] * RUNS
    one = common_shift(baseline, Point(NAMES, np.array([0.0, 0.0, 0.0, 5.0]), errors), NAMES)
    assert abs(one.shift) < 0.01


def test_one_run_is_a_baseline_too() -> None:
    one = common_shift([exact([0.0] * 4)], exact([0.0] * 4), NAMES)
    assert one.probability == pytest.approx(0.5)
    assert one.degrees_of_freedom == PRIOR_WEIGHT


def test_only_the_named_parameters_count_in_any_order() -> None:
    baseline = [exact([0.0] * 4)] * RUNS
    one = common_shift(baseline, exact([0.0, 0.2, 9.0, 9.0]), NAMES[1::-1])
    assert one.names == NAMES[1::-1]
    assert one.shift == pytest.approx(0.1)


def test_points_may_name_their_parameters_in_different_orders() -> None:
    errors = np.diag([1.0, 2.0, 3.0, 4.0])
    turned = Point(NAMES[::-1], np.arange(4.0)[::-1], errors[::-1, ::-1])
    assert turned.of(NAMES).value.tolist() == [0.0, 1.0, 2.0, 3.0]
    assert np.array_equal(turned.of(NAMES).covariance, errors)


def test_an_unknown_name_is_an_error() -> None:
    for point, now in ((exact([0.0] * 4), Point((), np.zeros(0), np.zeros((0, 0)))), (exact([0.0] * 4), exact([0.0] * 4))):
        with pytest.raises(ValueError, match=r".+"):
            common_shift([point], now, ["bearing.B9.kxx"])


def test_an_empty_baseline_is_an_error() -> None:
    with pytest.raises(ValueError, match="at least one identification"):
        common_shift([], exact([0.0] * 4), NAMES)
