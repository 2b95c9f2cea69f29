"""Drift against pymannkendall and SciPy, its interval and its false alarms by simulation."""

import numpy as np
import pymannkendall
import pytest
import scipy.stats
from hypothesis import given
from hypothesis import strategies as st

from estimator.trends.drift import Drift, TimeToLimit, drift, serial_correction, time_to_limit

WEEKS = np.arange(40.0)


def correlated(rng: np.random.Generator, count: int, alike: float) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    values = np.empty(count)
    values[0] = rng.standard_normal()
    for index in range(1, count):
        values[index] = alike * values[index - 1] + np.sqrt(1 - alike**2) * rng.standard_normal()
    return values


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("alike", [0.0, 0.6, -0.5])
def test_the_test_is_that_of_pymannkendall(seed: int, alike: float) -> None:
    values = correlated(np.random.default_rng(seed), WEEKS.size, alike) + 0.02 * WEEKS
    found = drift(WEEKS, values)
    corrected = found.correction > 1.0
    expected = (pymannkendall.hamed_rao_modification_test if corrected else pymannkendall.original_test)(values)
    assert found.slope == pytest.approx(expected.slope, rel=1e-12)
    assert found.statistic == pytest.approx(expected.z, rel=1e-9)
    assert found.probability == pytest.approx(expected.p, rel=1e-6, abs=1e-12)


@pytest.mark.parametrize("seed", range(5))
def test_slope_and_interval_are_those_of_scipy_where_nothing_is_correlated(seed: int) -> None:
    rng = np.random.default_rng(seed)
    time = np.sort(rng.uniform(0.0, 100.0, 25))
    values = 0.3 * time + rng.standard_normal(25)
    found = drift(time, values)
    slope, _, low, high = scipy.stats.theilslopes(values, time)
    assert found.slope == pytest.approx(slope, rel=1e-12)
    if found.correction == 1.0:
        # SciPy rounds to whole places among 300 slopes.
        assert (found.slope_lower, found.slope_upper) == pytest.approx((low, high), abs=0.002)


@pytest.mark.parametrize(("alike", "allowed"), [(0.0, 0.08), (0.5, 0.22), (0.7, 0.30)])
def test_false_alarms_are_fewer_than_without_the_correction(alike: float, allowed: float) -> None:
    """Of 5 % asked for, in 40 values. The correction helps, it does not heal: a short series hides most of its correlation."""
    rng = np.random.default_rng(7)
    series = [correlated(rng, 40, alike) for _ in range(400)]
    alarms = np.mean([drift(WEEKS, one).probability < 0.05 for one in series])
    plain = np.mean([pymannkendall.original_test(one).p < 0.05 for one in series])
    assert alarms < allowed
    assert alarms < plain - (0.05 if alike else -0.001)


def test_the_interval_holds_the_slope() -> None:
    rng = np.random.default_rng(3)
    held = 0
    for _ in range(300):
        found = drift(WEEKS, 0.05 * WEEKS + rng.standard_normal(40))
        held += found.slope_lower <= 0.05 <= found.slope_upper
    assert 0.90 <= held / 300 <= 0.985


def test_one_wild_value_moves_the_slope_little() -> None:
    values = 0.1 * WEEKS
    values[20] = 1e6
    assert drift(WEEKS, values).slope == pytest.approx(0.1, rel=1e-9)


@given(st.floats(-5, 5), st.floats(0.1, 10), st.floats(-100, 100))
def test_the_slope_follows_units_and_offsets(slope: float, unit: float, offset: float) -> None:
    rng = np.random.default_rng(0)
    values = slope * WEEKS + rng.standard_normal(40)
    found, scaled = drift(WEEKS, values), drift(unit * WEEKS + 3.0, values + offset)
    assert scaled.slope == pytest.approx(found.slope / unit, rel=1e-6, abs=1e-9)
    assert scaled.level == pytest.approx(found.level + offset, rel=1e-6, abs=1e-6)


def test_when_a_limit_is_reached() -> None:
    found = Drift(slope=0.1, slope_lower=0.05, slope_upper=0.2, level=1.0, statistic=5.0, probability=1e-6, correction=1.0)
    assert time_to_limit(found, 2.0) == TimeToLimit(10.0, 5.0, 20.0)
    assert time_to_limit(found, 0.0) == TimeToLimit(None, None, None)
    unsure = Drift(slope=0.1, slope_lower=-0.05, slope_upper=0.2, level=1.0, statistic=1.0, probability=0.3, correction=1.0)
    assert time_to_limit(unsure, 2.0) == TimeToLimit(10.0, 5.0, None)


def test_equal_values_do_not_drift() -> None:
    found = drift(WEEKS, np.full(40, 2.0))
    assert (found.slope, found.statistic, found.probability) == (0.0, 0.0, 1.0)
    assert serial_correction(np.zeros(10)) == 1.0


@pytest.mark.parametrize("time", [np.arange(3.0), np.array([0.0, 1.0, 1.0, 2.0])])
def test_too_few_and_unordered_times_are_said(time: np.ndarray[tuple[int], np.dtype[np.float64]]) -> None:
    with pytest.raises(ValueError, match=r"at least 4|must ascend"):
        drift(time, np.zeros(time.size))
