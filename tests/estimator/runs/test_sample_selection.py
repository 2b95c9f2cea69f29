"""Tests which samples make a run: by change of speed and time, and thinned evenly."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.runs.sample_selection import select_samples, thinned
from tests.estimator.trains import few_examples

SECOND = 1_000_000_000


def seconds(count: int) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    return SECOND * np.arange(count, dtype=np.int64)


def test_without_limits_every_sample_is_kept() -> None:
    assert select_samples(time=seconds(5), speed=np.ones(5)).tolist() == [0, 1, 2, 3, 4]


def test_by_change_of_speed_alone_a_hold_keeps_one_sample() -> None:
    speed = np.array([10.0, 10.4, 11.0, 11.0, 11.0, 9.9, 9.8])
    assert select_samples(time=seconds(7), speed=speed, delta_speed=1.0).tolist() == [0, 2, 5]


def test_by_time_alone_the_speed_does_not_matter() -> None:
    assert select_samples(time=seconds(7), speed=np.arange(7.0), delta_time=3 * SECOND).tolist() == [0, 3, 6]


def test_by_both_either_is_enough() -> None:
    speed = np.array([10.0, 12.0, 12.0, 12.0, 12.0, 12.0])
    assert select_samples(time=seconds(6), speed=speed, delta_speed=1.0, delta_time=3 * SECOND).tolist() == [0, 1, 4]


@few_examples
@given(st.lists(st.floats(0, 300), min_size=1, max_size=60), st.floats(0.1, 50), st.integers(1, 20))
def test_whatever_is_left_out_is_near_the_one_kept_before(speeds: list[float], change: float, wait: int) -> None:
    speed = np.array(speeds)
    kept = select_samples(time=seconds(speed.size), speed=speed, delta_speed=change, delta_time=wait * SECOND)
    assert kept[0] == 0
    for i in range(speed.size):
        last = kept[kept <= i][-1]
        assert i == last or (abs(speed[i] - speed[last]) < change and i - last < wait)


def test_few_samples_are_not_thinned() -> None:
    assert thinned(time=seconds(100), speed=np.arange(100.0), count=100).tolist() == list(range(100))


def test_a_thinned_run_keeps_speeds_and_times_evenly() -> None:
    """A minute of sweep between two hours of hold: the sweep's speeds stay dense, the hold stays."""
    speed = np.concatenate([np.full(36_000, 300.0), np.linspace(300.0, 30.0, 600), np.full(36_000, 30.0)])
    kept = thinned(time=seconds(speed.size) // 10, speed=speed, count=400)
    assert 390 <= kept.size <= 400
    assert np.all(np.diff(kept) > 0)
    assert np.max(-np.diff(speed[kept])) == pytest.approx(270 / 200, rel=0.5)
    assert np.max(np.diff(kept)) <= 72_600 / 190
    assert {0, speed.size - 1} <= set(kept.tolist())


@pytest.mark.parametrize("noise", [0.1, 1.0, 3.0])
def test_noise_of_the_speed_in_a_long_hold_takes_nothing_from_a_short_sweep(noise: float) -> None:
    """A minute of sweep between two hours of hold, as above, with noisy readings."""
    speed = np.concatenate([np.full(36_000, 300.0), np.linspace(300.0, 30.0, 600), np.full(36_000, 30.0)])
    speed += noise * np.random.default_rng(1).standard_normal(speed.size)
    kept = thinned(time=seconds(speed.size) // 10, speed=speed, count=400)
    assert 350 <= kept.size <= 400
    swept = kept[(kept >= 36_000) & (kept < 36_600)]
    assert swept.size > 130
    assert np.max(np.diff(swept)) <= 12


def test_a_steady_sweep_is_thinned_to_the_number_asked_for() -> None:
    kept = thinned(time=seconds(6000), speed=np.linspace(300.0, 30.0, 6000), count=600)
    assert kept.size == 600
    assert np.ptp(np.diff(kept)) <= 1


@few_examples
@given(st.lists(st.floats(0, 300), min_size=1, max_size=200), st.integers(4, 50))
def test_thinning_keeps_both_ends_and_no_more_than_asked(speeds: list[float], count: int) -> None:
    kept = thinned(time=seconds(len(speeds)), speed=np.array(speeds), count=count)
    assert kept.size <= count
    assert {0, len(speeds) - 1} <= set(kept.tolist())
    assert np.all(np.diff(kept) > 0)
