"""Runs from speeds: where each kind of run begins and ends, why, and that neither jitter nor a restart changes it.

The machine runs between 300 and 3000 r/min; a span is a part of these 2700 r/min. Samples come a second apart.
"""

import json
from collections.abc import Iterable, Sequence

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.machine.rules import Operation, SpeedRange
from estimator.runs.segmentation import (
    REVERSAL_SPAN,
    START_SPAN,
    RunEnded,
    RunEvent,
    RunStarted,
    SweepLimits,
    SweepState,
    advance,
    finish,
)
from estimator.units import rpm_to_rad_per_s
from tests.estimator.trains import few_examples

SECOND = 1_000_000_000
LIMITS = SweepLimits.of(SpeedRange(minimum_rpm=300, maximum_rpm=3000))
SPAN = 2700.0
"""[r/min]"""
START, REVERSAL = START_SPAN * SPAN, REVERSAL_SPAN * SPAN

Sample = tuple[float, float, int]
"""Time [s], speed [r/min], direction."""


def every_second(*stretches: Iterable[float], direction: int = 1, start: float = 0.0) -> list[Sample]:
    """Stretches of speeds as samples a second apart."""
    speeds = [speed for stretch in stretches for speed in stretch]
    return [(start + i, speed, direction) for i, speed in enumerate(speeds)]


def ramp(first: float, last: float, count: int = 50) -> list[float]:
    """Steady speeds, both ends among them."""
    return [first + (last - first) * i / (count - 1) for i in range(count)]


def follow(samples: Sequence[Sample], state: SweepState | None = None) -> tuple[SweepState, list[RunEvent]]:
    state = state or SweepState()
    events: list[RunEvent] = []
    for seconds, rpm, direction in samples:
        time = round(seconds * SECOND)
        state, new = advance(state, LIMITS, time=time, speed=rpm_to_rad_per_s(rpm), direction=direction)
        events += new
    return state, events


def words(events: Sequence[RunEvent]) -> list[str]:
    """Events as a person would tell them, times in seconds."""
    told = []
    for event in events:
        if isinstance(event, RunStarted):
            told.append(f"{event.kind} from {event.time / SECOND:g}")
        else:
            told.append(f"{event.kind} {event.start / SECOND:g} to {event.time / SECOND:g}: {event.reason}")
    return told


def told(samples: Sequence[Sample]) -> list[str]:
    return words(follow(samples)[1])


# --- each kind of beginning and end ---------------------------------------------------------------------------------


def test_limits_are_those_of_the_machine() -> None:
    assert LIMITS.minimum == pytest.approx(rpm_to_rad_per_s(300.0))
    assert LIMITS.span(0.5) == pytest.approx(rpm_to_rad_per_s(1350.0))


def test_a_run_down_ends_at_the_last_sample_in_the_range() -> None:
    samples = every_second(ramp(2990.0, 310.0), [290.0, 100.0, 0.0])
    assert told(samples) == ["run-down from 0", "run-down 0 to 49: the speed left the speed range"]


def test_a_run_up_begins_with_the_first_sample_in_the_range() -> None:
    samples = every_second([0.0, 150.0, 299.0], ramp(310.0, 2990.0))
    state, events = follow(samples)
    assert words(events) == ["run-up from 3"]
    assert words(finish(state, LIMITS, reason="enough")[1]) == ["run-up 3 to 52: enough"]


def test_a_run_begins_where_the_speed_last_stood() -> None:
    assert told(every_second([2990.0] * 30, ramp(2930.0, 1000.0))) == ["run-down from 29"]
    assert told(every_second([350.0] * 30, ramp(410.0, 2000.0))) == ["run-up from 29"]


def test_a_hold_is_no_run() -> None:
    wobble = [1500.0 + (START / 2 - 1) * (-1) ** i for i in range(500)]
    assert told(every_second([1500.0] * 500)) == []
    assert told(every_second(wobble)) == []


def test_a_run_needs_its_span() -> None:
    assert told(every_second([1000.0, *[1000.0 + 0.999 * START] * 3])) == []
    assert told(every_second([1000.0, *[1000.0 + 1.001 * START] * 3])) == ["run-up from 0"]
    assert told(every_second([1000.0, *[1000.0 - 1.001 * START] * 3])) == ["run-down from 0"]


def test_a_run_up_that_turns_back_is_followed_by_a_run_down_from_the_top() -> None:
    samples = every_second(ramp(310.0, 2500.0), [2500.0], ramp(2450.0, 400.0))
    assert told(samples) == ["run-up from 0", "run-up 0 to 49: the speed turned back", "run-down from 50"]


def test_a_run_down_that_turns_back_is_followed_by_a_run_up_from_the_bottom() -> None:
    samples = every_second(ramp(2900.0, 800.0), [800.0], ramp(840.0, 2900.0))
    assert told(samples) == ["run-down from 0", "run-down 0 to 49: the speed turned back", "run-up from 50"]


def test_one_step_back_may_be_the_next_run_already() -> None:
    samples = every_second(ramp(2900.0, 800.0), [800.0, *[800.0 + 1.01 * START] * 2])
    assert told(samples) == ["run-down from 0", "run-down 0 to 49: the speed turned back", "run-up from 50"]


def test_a_sharp_turn_is_placed_to_a_sample() -> None:
    """The one sample at the very top cannot be told from a wrong reading."""
    samples = every_second(ramp(310.0, 2500.0), ramp(2450.0, 400.0))
    assert told(samples) == ["run-up from 0", "run-up 0 to 48: the speed turned back", "run-down from 49"]


def test_a_short_hold_between_run_up_and_run_down_belongs_to_neither() -> None:
    """As a hold longer than the stall does: a run begins where the speed last stood at the extreme it now leaves."""
    samples = every_second(ramp(310.0, 2990.0), [2990.0] * 60, ramp(2930.0, 310.0))
    assert told(samples) == ["run-up from 0", "run-up 0 to 49: the speed turned back", "run-down from 109"]


def test_a_long_hold_ends_a_run_where_it_began_to_stand() -> None:
    samples = every_second(ramp(310.0, 2990.0), [2990.0] * 300, ramp(2930.0, 310.0))
    assert told(samples) == ["run-up from 0", "run-up 0 to 49: the speed stood still", "run-down from 349"]


def test_a_run_stands_for_a_while_and_goes_on() -> None:
    samples = every_second(ramp(2990.0, 1500.0), [1500.0] * 119, ramp(1490.0, 310.0), [200.0] * 2)
    assert told(samples) == ["run-down from 0", "run-down 0 to 218: the speed left the speed range"]


def test_a_small_step_back_is_no_reversal() -> None:
    back = 0.99 * REVERSAL
    samples = every_second(ramp(2990.0, 1500.0), [1500.0 + back, 1500.0 + back], ramp(1450.0, 310.0))
    assert told(samples) == ["run-down from 0"]


def test_a_pause_in_the_data_ends_a_run_before_it() -> None:
    before, after = every_second(ramp(2990.0, 1500.0)), every_second(ramp(1490.0, 310.0), start=49 + 120.5)
    assert told(before + after) == ["run-down from 0", "run-down 0 to 49: a pause in the data", "run-down from 169.5"]


def test_a_shorter_pause_ends_nothing() -> None:
    before, after = every_second(ramp(2990.0, 1500.0)), every_second(ramp(1490.0, 310.0), start=49 + 119.5)
    assert told(before + after) == ["run-down from 0"]


def test_a_pause_forgets_where_the_speed_stood() -> None:
    samples = every_second([1000.0] * 10) + every_second([1000.0 + 2 * START] * 10, start=500)
    assert told(samples) == []


def test_a_change_of_direction_ends_a_run() -> None:
    before = every_second(ramp(2990.0, 1500.0))
    after = every_second(ramp(1490.0, 310.0), direction=-1, start=50)
    assert told(before + after) == ["run-down from 0", "run-down 0 to 49: the sense of rotation changed", "run-down from 50"]


def test_a_change_of_direction_at_rest_begins_afresh() -> None:
    samples = every_second([400.0] * 5) + every_second([400.0 + 1.5 * START] * 5, direction=-1, start=5)
    assert told(samples) == []


def test_below_the_range_there_is_no_run() -> None:
    assert told(every_second(ramp(0.0, 299.0), ramp(299.0, 0.0))) == []


def test_below_the_range_a_pause_or_a_change_of_direction_is_nothing() -> None:
    samples = every_second(ramp(310.0, 0.0)) + every_second(ramp(0.0, 310.0), direction=-1, start=5000)
    assert told(samples) == []


def test_finish_without_a_run_says_nothing() -> None:
    state, _ = follow(every_second([1500.0] * 5))
    assert finish(state, LIMITS, reason="enough") == (SweepState(readings=state.readings.restarted()), ())


@pytest.mark.parametrize("turns", [1, 2, 5])
def test_every_sweep_of_many_is_one_run(turns: int) -> None:
    sweeps = [sweep for _ in range(turns) for sweep in (ramp(310.0, 2990.0), ramp(2980.0, 310.0))]
    state, events = follow(every_second(*sweeps, [100.0] * 2))
    kinds = [event.kind for event in events if isinstance(event, RunEnded)]
    assert kinds == ["run-up", "run-down"] * turns
    assert state.sweep == 0


# --- wrong and noisy readings, heat soaks ---------------------------------------------------------------------------


def test_one_wrong_reading_neither_breaks_a_run_nor_makes_one() -> None:
    sweep = ramp(310.0, 2990.0)
    for wrong in (0.0, 900.0, 3000.0):
        samples = every_second([*sweep[:20], wrong, *sweep[20:], *[2990.0] * 300])
        assert told(samples) == ["run-up from 0", "run-up 0 to 50: the speed stood still"]
        assert told(every_second([*[2000.0] * 50, wrong, *[2000.0] * 50])) == []


def test_a_heat_soak_does_not_end_a_run_up() -> None:
    samples = every_second(ramp(310.0, 1500.0), [1500.0] * 3500, ramp(1510.0, 2990.0), [2990.0] * 300)
    assert told(samples) == ["run-up from 0", "run-up 0 to 3599: the speed stood still"]


def test_a_longer_hold_on_the_way_ends_a_run_up_where_it_began() -> None:
    samples = every_second(ramp(310.0, 1500.0), [1500.0] * 3700, ramp(1510.0, 2990.0))
    assert told(samples) == ["run-up from 0", "run-up 0 to 49: the speed stood still", "run-up from 3749"]


def test_the_document_says_how_long_a_hold_may_last() -> None:
    limits = SweepLimits.of(SpeedRange(minimum_rpm=300, maximum_rpm=3000), Operation(longest_hold_s=600, longest_pause_s=60))
    assert (limits.hold, limits.gap) == (600 * SECOND, 60 * SECOND)


NOISE = [0.0, 0.002, 0.005, 0.01, 0.015]
"""Standard deviation of a reading, part of the highest speed."""


def noisy(rpm: Sequence[float], noise: float, seed: int) -> list[float]:
    readings = np.asarray(rpm) + 3000.0 * noise * np.random.default_rng(seed).standard_normal(len(rpm))
    return [max(0.0, reading) for reading in readings.tolist()]


@pytest.mark.parametrize("noise", NOISE)
def test_noise_makes_no_sweep_at_any_sampling_rate(noise: float) -> None:
    for seed, (step, speed) in enumerate(
        (step, speed) for step in (0.02, 0.1, 1.0, 10.0) for speed in (800.0, 1800.0, 2950.0)
    ):
        samples = [(step * i, reading, 1) for i, reading in enumerate(noisy([speed] * 2000, noise, seed))]
        assert told(samples) == []


@pytest.mark.parametrize("noise", NOISE)
@pytest.mark.parametrize("step", [0.1, 1.0, 5.0])
def test_noise_breaks_no_sweep(noise: float, step: float) -> None:
    """Five minutes each of hold, coast-down, standstill, run-up, hold: two runs, with nearly all of their samples."""
    count = round(300.0 / step)
    cycle = [[2900.0] * count, ramp(2900.0, 150.0, count), [0.0] * count, ramp(150.0, 2900.0, count), [2900.0] * count]
    for seed in range(8 if step >= 1.0 else 2):
        readings = noisy([speed for stretch in cycle for speed in stretch], noise, seed)
        _, events = follow([(step * i, reading, 1) for i, reading in enumerate(readings)])
        ended = [event for event in events if isinstance(event, RunEnded)]
        assert [event.kind for event in ended] == ["run-down", "run-up"]
        for event, (first, last) in zip(ended, [(300.0, 583.6), (916.4, 1200.0)], strict=True):
            assert event.start / SECOND == pytest.approx(first, abs=30 if noise else 3 * step)
            # At the top of a run-up noise may climb on for a while.
            assert last - 30 <= event.time / SECOND <= last + (120 if noise else 3 * step)


# --- properties -----------------------------------------------------------------------------------------------------

unit = st.floats(-1.0, 1.0)


@few_examples
@given(st.lists(unit, min_size=30, max_size=150), st.booleans())
def test_a_sweep_with_jitter_below_the_hysteresis_is_one_run(jitter: list[float], upwards: bool) -> None:
    """The jitter from its lowest to its highest is just less than the span by which a speed must come back."""
    inside = REVERSAL / 2.01
    first, last = (310.0 + inside, 2990.0 - inside) if upwards else (2990.0 - inside, 310.0 + inside)
    speeds = [speed + inside * noise for speed, noise in zip(ramp(first, last, len(jitter)), jitter, strict=True)]
    state, events = follow(every_second(speeds))
    (started,) = events
    assert isinstance(started, RunStarted)
    assert started.kind == ("run-up" if upwards else "run-down")
    _, (ended,) = finish(state, LIMITS, reason="enough")
    assert isinstance(ended, RunEnded)
    assert ended.start == started.time
    # All but the ends, where jitter decides which sample was the extreme one.
    assert (ended.time - ended.start) / SECOND >= 0.95 * len(jitter) - 3


samples_anyhow = st.lists(
    st.tuples(st.sampled_from([0.5, 1.0, 30.0, 119.0, 121.0]), st.floats(200.0, 3200.0), st.sampled_from([1, 1, 1, 1, -1])),
    min_size=1,
    max_size=60,
)


def in_time(steps: Sequence[tuple[float, float, int]]) -> list[Sample]:
    """Samples whose first number was the time since the one before."""
    now, result = 0.0, []
    for step, rpm, direction in steps:
        now += step
        result.append((now, rpm, direction))
    return result


@few_examples
@given(samples_anyhow, st.data())
def test_a_restart_anywhere_changes_nothing(steps: list[tuple[float, float, int]], data: st.DataObject) -> None:
    samples = in_time(steps)
    cut = data.draw(st.integers(0, len(samples)))
    before, first = follow(samples[:cut])
    restored = SweepState.restored(json.loads(json.dumps(msgspec.to_builtins(before))))
    assert restored == before
    after, second = follow(samples[cut:], restored)
    assert (after, first + second) == follow(samples)


@few_examples
@given(samples_anyhow)
def test_runs_follow_each_other_and_end_after_they_began(steps: list[tuple[float, float, int]]) -> None:
    state, events = follow(in_time(steps))
    events += finish(state, LIMITS, reason="enough")[1]
    assert len(events) % 2 == 0
    last = -1
    for started, ended in zip(events[::2], events[1::2], strict=True):
        assert isinstance(started, RunStarted)
        assert isinstance(ended, RunEnded)
        assert (started.time, started.kind) == (ended.start, ended.kind)
        assert last <= started.time < ended.time
        last = ended.time


def test_hours_at_speed_with_a_stray_reading_are_no_part_of_the_run_down() -> None:
    at_speed = [2980.0 + (4.0 if i % 2 else -4.0) for i in range(7200)]
    at_speed[30] = 2995.0
    (started,) = [event for event in follow(every_second(at_speed, ramp(2970.0, 310.0)))[1] if isinstance(event, RunStarted)]
    assert started.time >= (7200 - 130) * 1_000_000_000
