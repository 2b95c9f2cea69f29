"""Speed bins: the newest samples in each, bounded, spaced, recent, whatever the batches."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from estimator.runs.speed_bins import SpeedBins, filled
from estimator.units import rpm_to_rad_per_s
from tests.estimator.trains import few_examples
from tests.plant import machine

SECOND = 1_000_000_000
RULES = {"bins": 9, "samples_per_bin": 3, "spacing_s": 2.0, "recency_s": 100.0, "coverage": 0.5}
"""Bins of 300 r/min from 300 to 3000."""
MACHINE = machine(collection={"runs": "rolling", "rolling": RULES})


def fill(readings: list[tuple[float, float]], bins: SpeedBins | None = None) -> SpeedBins:
    """Readings of seconds and r/min."""
    time = np.array([round(second * SECOND) for second, _ in readings], dtype=np.int64)
    speed = rpm_to_rad_per_s(1.0) * np.array([rpm for _, rpm in readings])
    return filled(bins or SpeedBins.empty(MACHINE), MACHINE, time=time, speed=speed)


def in_seconds(bins: SpeedBins) -> list[list[float]]:
    return [[time / SECOND for time in times] for times in bins.times]


def test_each_sample_lies_in_the_bin_of_its_speed() -> None:
    bins = fill([(0, 300.0), (1, 601.0), (2, 899.0), (3, 2999.0), (4, 299.0), (5, 3001.0)])
    assert in_seconds(bins) == [[0], [1], [], [], [], [], [], [], [3]]
    assert bins.coverage == 3 / 9
    assert bins.all_times == [0, SECOND, 3 * SECOND]


def test_the_newest_stay_and_keep_their_distance() -> None:
    bins = fill([(second, 1000.0) for second in (0, 1, 2, 3, 4, 5, 6, 7)])
    assert in_seconds(bins)[2] == [2, 4, 6]


def test_what_is_old_is_left_out() -> None:
    bins = fill([(0, 400.0), (50, 1000.0), (120, 2000.0)])
    assert bins.recent(MACHINE, 149 * SECOND).coverage == 2 / 9
    assert bins.recent(MACHINE, 151 * SECOND).coverage == 1 / 9


@few_examples
@given(st.lists(st.tuples(st.floats(0.1, 5.0), st.floats(200.0, 3200.0)), max_size=80), st.integers(0, 80))
def test_batches_do_not_matter_and_memory_is_bounded(steps: list[tuple[float, float]], cut: int) -> None:
    second, readings = 0.0, []
    for step, rpm in steps:
        second += step
        readings.append((second, rpm))
    whole = fill(readings)
    assert fill(readings[cut:], fill(readings[:cut])) == whole
    for times in whole.times:
        assert len(times) <= 3
        assert all(later - earlier >= 2 * SECOND for earlier, later in zip(times, times[1:], strict=False))
