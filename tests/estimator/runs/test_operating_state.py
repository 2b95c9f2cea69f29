"""Tests what a machine is doing: every state in its turn, trips told from controlled run-downs, noise and restarts without
effect.

The machine of `tests.plant` runs between 300 and 3000 r/min and stands still below 30. Samples come a second apart.
"""

import json
from collections.abc import Sequence

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.runs.operating_state import (
    FEWEST_RUNS,
    TRIP_RATIO,
    ModeChanged,
    OperatingEvent,
    OperatingLimits,
    OperatingState,
    advance,
    silence,
)
from estimator.runs.segmentation import RunEnded, RunStarted
from estimator.units import rpm_to_rad_per_s
from tests.estimator.trains import few_examples
from tests.plant import machine

SECOND = 1_000_000_000
LIMITS = OperatingLimits.of(machine())
WHOLE = ["stopped", "slow roll", "run-up", "at speed", "run-down", "slow roll", "stopped"]
"""The states of a cycle."""


def ramp(first: float, last: float, seconds: int) -> list[float]:
    """A steady change, a sample a second, both ends among them."""
    return list(map(float, np.linspace(first, last, seconds + 1)))


def follow(
    rpm: Sequence[float], limits: OperatingLimits = LIMITS, state: OperatingState | None = None, *, start: int = 0
) -> tuple[OperatingState, list[OperatingEvent]]:
    state = state or OperatingState()
    events: list[OperatingEvent] = []
    for i, speed in enumerate(rpm, start=start):
        state, new = advance(state, limits, time=i * SECOND, speed=rpm_to_rad_per_s(speed), direction=1)
        events += new
    return state, events


def modes(events: Sequence[OperatingEvent]) -> list[tuple[str, float]]:
    """Each state with the second since when it holds."""
    return [(event.mode, event.time / SECOND) for event in events if isinstance(event, ModeChanged)]


def cycle(down_s: int = 270, *, top: float = 2900.0) -> list[float]:
    """Standstill, slow roll, run-up, a hold at speed, a run-down within so many seconds, standstill."""
    up = [*[0.0] * 60, *ramp(0.0, 100.0, 20), *[100.0] * 60, *ramp(100.0, top, 280), *[top] * 300]
    return [*up, *ramp(top, 0.0, down_s), *[0.0] * 60]


def test_a_cycle_passes_every_state_once_and_in_order() -> None:
    state, events = follow(cycle())
    assert [mode for mode, _ in modes(events)] == [
        "stopped",
        "slow roll",
        "run-up",
        "at speed",
        "run-down",
        "slow roll",
        "stopped",
    ]
    seconds = [second for _, second in modes(events)]
    assert seconds == sorted(seconds)
    # 45 r/min are passed at 69 s, 300 r/min at 160 s; the hold is called one two minutes after it began.
    assert seconds[:3] == [0.0, 69.0, pytest.approx(160.0, abs=2)]
    assert seconds[4] == pytest.approx(720.0, abs=3)
    assert (state.mode, state.since) == ("stopped", round(seconds[-1] * SECOND))


def test_run_events_come_with_the_states() -> None:
    _, events = follow(cycle())
    kinds = [(type(event), event.kind) for event in events if isinstance(event, RunStarted | RunEnded)]
    assert kinds == [(RunStarted, "run-up"), (RunEnded, "run-up"), (RunStarted, "run-down"), (RunEnded, "run-down")]


def test_between_two_speeds_in_the_range_there_is_no_slow_roll() -> None:
    _, events = follow([*[1500.0] * 300, *[1560.0] * 300])
    assert modes(events) == [("at speed", 0.0)]


def test_slow_roll_just_inside_the_range_stays_slow_roll() -> None:
    _, events = follow([*[250.0] * 60, *[350.0] * 600])
    assert [mode for mode, _ in modes(events)] == ["slow roll"]


def test_a_trip_is_a_run_down_faster_than_the_document_calls_controlled() -> None:
    limits = OperatingLimits.of(machine(operation={"controlled_deceleration_rpm_per_s": 20}))
    assert "trip" not in [mode for mode, _ in modes(follow(cycle(270), limits)[1])]
    _, events = follow(cycle(60), limits)
    told = [mode for mode, _ in modes(events)]
    assert told[3:] == ["at speed", "run-down", "trip", "slow roll", "stopped"]
    since = dict(modes(events))
    assert since["trip"] == since["run-down"] == pytest.approx(720.0, abs=3)


def test_a_fast_run_down_from_low_speed_is_no_trip() -> None:
    limits = OperatingLimits.of(machine(operation={"controlled_deceleration_rpm_per_s": 20}))
    _, events = follow(cycle(20, top=1400.0), limits)
    assert "trip" not in [mode for mode, _ in modes(events)]


def test_without_a_number_a_trip_is_recognised_by_the_machines_own_run_downs() -> None:
    state, start, told = OperatingState(), 0, []
    for down_s in (60, *[270] * FEWEST_RUNS, 240, round(270 / TRIP_RATIO) - 20, 270):
        speeds = cycle(down_s)
        state, events = follow(speeds, state=state, start=start)
        start += len(speeds)
        told.append("trip" in [mode for mode, _ in modes(events)])
    # The first one is fast, but nothing is known yet; a trip does not make the next one usual.
    assert told == [False, False, False, False, False, True, False]


def test_a_trip_in_a_run_up_is_seen_at_once() -> None:
    """As in an overspeed test: no hold in between."""
    limits = OperatingLimits.of(machine(operation={"controlled_deceleration_rpm_per_s": 20}))
    _, events = follow([*ramp(100.0, 2900.0, 280), *ramp(2850.0, 0.0, 60), 0.0, 0.0], limits)
    assert [mode for mode, _ in modes(events)] == ["slow roll", "run-up", "run-down", "trip", "slow roll", "stopped"]


def test_after_silence_the_state_is_unknown_and_the_run_over() -> None:
    state, _ = follow(cycle()[:800])
    assert state.mode == "run-down"
    state, events = silence(state, LIMITS, reason="the source fell silent")
    assert [type(event) for event in events] == [RunEnded, ModeChanged]
    assert (state.mode, state.since) == ("unknown", 799 * SECOND)
    assert silence(state, LIMITS, reason="again") == (state, ())


@pytest.mark.parametrize("noise", [0.002, 0.01, 0.02])
def test_noise_changes_no_state(noise: float) -> None:
    """Of this part of the speed, standard deviation: a keyphasor errs in time."""
    for seed in range(10):
        rng = np.random.default_rng(seed)
        rpm = [speed * (1.0 + noise * float(rng.standard_normal())) for speed in cycle(600)]
        told = [mode for mode, _ in modes(follow(rpm)[1])]
        assert told == WHOLE


@few_examples
@given(st.lists(st.floats(0.0, 3900.0), min_size=1, max_size=80), st.integers(0, 80))
def test_a_restart_anywhere_changes_nothing(rpm: list[float], cut: int) -> None:
    before, first = follow(rpm[:cut])
    restored = OperatingState.restored(json.loads(json.dumps(msgspec.to_builtins(before))))
    assert restored == before
    after, second = follow(rpm[cut:], state=restored, start=min(cut, len(rpm)))
    assert (after, first + second) == follow(rpm)


@few_examples
@given(st.lists(st.floats(0.0, 3900.0), min_size=1, max_size=80))
def test_states_never_go_back_in_time(rpm: list[float]) -> None:
    _, events = follow(rpm)
    since = [second for _, second in modes(events)]
    assert since == sorted(since)


def test_what_an_older_release_stored_begins_afresh() -> None:
    old = {"sweep": {"sweep": -1, "direction": 1, "last_time": 5, "run_start": 3, "high_time": 3}}
    state = OperatingState.restored(old)
    assert (state.sweep.sweep, state.sweep.run_start, state.mode) == (-1, 3, "unknown")
