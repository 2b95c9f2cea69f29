"""From a stream of speeds to runs: where a run-up or a run-down begins and ends.

A pure state machine: `advance` takes the state so far and one sample and returns the next state and what happened. The
state is plain data, so that it can be stored beside the samples and a restart goes on exactly where it stopped.
"""

from dataclasses import dataclass, replace
from typing import Literal

from estimator.machine import SpeedRange
from estimator.units import rpm_to_rad_per_s

RunKind = Literal["run-up", "run-down"]

START_SPAN = 0.05
"""Part of the speed range that the speed must cross in one sense before a run is seen to have begun."""
REVERSAL_SPAN = 0.02
"""Part of the speed range by which the speed must come back for the run to be over."""
PLATEAU_SPAN = 0.001
"""Changes below this part of the speed range count as standing still."""


@dataclass(frozen=True)
class SweepLimits:
    """What counts as a sweep on one machine.

    minimum, maximum: of the speed range [rad/s]. stall: a sweep without progress for this long is over [ns]. gap: a pause in
    the data as long as this ends a run [ns].
    """

    minimum: float
    maximum: float
    stall: int = 120_000_000_000
    gap: int = 120_000_000_000

    @classmethod
    def of(cls, speed_range: SpeedRange) -> "SweepLimits":
        """The limits that a machine's speed range implies."""
        return cls(rpm_to_rad_per_s(speed_range.minimum_rpm), rpm_to_rad_per_s(speed_range.maximum_rpm))

    def span(self, part: float) -> float:
        """A part of the speed range [rad/s]."""
        return part * (self.maximum - self.minimum)


@dataclass(frozen=True)
class SweepState:
    """What is remembered between samples. Times [ns], speeds [rad/s]; sweep: +1 in a run-up, -1 in a run-down, else 0.

    low and high: the lowest and highest speed since the last run, and when they were last held; in a sweep the extreme
    reached so far is the one it moves towards, with the time when it was first reached, and held_time when it was last held.
    """

    sweep: int = 0
    direction: int = 0
    last_time: int | None = None
    low_speed: float = 0.0
    low_time: int = 0
    high_speed: float = 0.0
    high_time: int = 0
    held_time: int = 0
    run_start: int = 0


@dataclass(frozen=True)
class RunStarted:
    """A run began with the sample at `time` [ns]."""

    time: int
    kind: RunKind


@dataclass(frozen=True)
class RunEnded:
    """The run in progress ended with the sample at `time` [ns], for a reason in words."""

    start: int
    time: int
    kind: RunKind
    reason: str


RunEvent = RunStarted | RunEnded


def advance(
    state: SweepState, limits: SweepLimits, *, time: int, speed: float, direction: int
) -> tuple[SweepState, tuple[RunEvent, ...]]:
    """Take one sample, later than all before it: time [ns], spin speed [rad/s], direction +1 or -1."""
    events: list[RunEvent] = []
    if state.last_time is not None and time - state.last_time > limits.gap:
        state, ended = finish(state, reason="a pause in the data")
        events += ended
    elif state.sweep and direction != state.direction:
        state, ended = finish(state, reason="the sense of rotation changed")
        events += ended
    if speed < limits.minimum:
        state, ended = _below_range(state)
        events += ended
    elif state.last_time is None:
        state = _rest(time, speed, direction)
    elif state.sweep == 0:
        state, started = _watch(state, limits, time, speed, direction)
        events += started
    else:
        state, ended = _follow(state, limits, time, speed, direction)
        events += ended
    return replace(state, last_time=time if speed >= limits.minimum else None), tuple(events)


def finish(state: SweepState, *, reason: str) -> tuple[SweepState, tuple[RunEvent, ...]]:
    """End the run in progress, if there is one, at the extreme that it reached, and forget what came before."""
    if state.sweep == 0:
        return SweepState(), ()
    end = state.high_time if state.sweep > 0 else state.low_time
    return SweepState(), (RunEnded(state.run_start, end, _kind(state.sweep), reason),)


def _kind(sweep: int) -> RunKind:
    return "run-up" if sweep > 0 else "run-down"


def _rest(time: int, speed: float, direction: int) -> SweepState:
    return SweepState(direction=direction, last_time=time, low_speed=speed, low_time=time, high_speed=speed, high_time=time)


def _below_range(state: SweepState) -> tuple[SweepState, tuple[RunEvent, ...]]:
    return finish(state, reason="the speed left the speed range")


def _watch(
    state: SweepState, limits: SweepLimits, time: int, speed: float, direction: int
) -> tuple[SweepState, tuple[RunEvent, ...]]:
    """No run in progress: does one begin? It begins where the speed last stood at the extreme it now leaves."""
    if direction != state.direction:
        return _rest(time, speed, direction), ()
    if speed - state.low_speed >= limits.span(START_SPAN):
        began = replace(state, sweep=1, run_start=state.low_time, high_speed=speed, high_time=time, held_time=time)
        return began, (RunStarted(state.low_time, "run-up"),)
    if state.high_speed - speed >= limits.span(START_SPAN):
        began = replace(state, sweep=-1, run_start=state.high_time, low_speed=speed, low_time=time, held_time=time)
        return began, (RunStarted(state.high_time, "run-down"),)
    if time - min(state.low_time, state.high_time) > limits.stall and not _leaving(state, limits, speed):
        return _rest(time, speed, direction), ()  # an old extreme must not pull hours at speed into the next run
    still = limits.span(PLATEAU_SPAN)
    if speed <= state.low_speed + still:
        state = replace(state, low_speed=min(speed, state.low_speed), low_time=time)
    if speed >= state.high_speed - still:
        state = replace(state, high_speed=max(speed, state.high_speed), high_time=time)
    return state, ()


def _leaving(state: SweepState, limits: SweepLimits, speed: float) -> bool:
    """Whether the speed has moved so far from an extreme that a slow sweep may be under way."""
    return max(speed - state.low_speed, state.high_speed - speed) > limits.span(REVERSAL_SPAN)


def _follow(
    state: SweepState, limits: SweepLimits, time: int, speed: float, direction: int
) -> tuple[SweepState, tuple[RunEvent, ...]]:
    """A run in progress: does it go on, come back, or stand still?"""
    reached, reached_at = (state.high_speed, state.high_time) if state.sweep > 0 else (state.low_speed, state.low_time)
    progress = state.sweep * (speed - reached)
    if progress > 0:
        if state.sweep > 0:
            return replace(state, high_speed=speed, high_time=time, held_time=time), ()
        return replace(state, low_speed=speed, low_time=time, held_time=time), ()
    if -progress <= limits.span(PLATEAU_SPAN):
        state = replace(state, held_time=time)
    if -progress >= limits.span(REVERSAL_SPAN):
        _, ended = finish(state, reason="the speed turned back")
        # The next run may already be under way: it began at the extreme just left.
        rest = _rest(state.held_time, reached, direction)
        return _watch(rest, limits, time, speed, direction)[0], (*ended, *_watch(rest, limits, time, speed, direction)[1])
    if time - reached_at >= limits.stall:
        _, ended = finish(state, reason="the speed stood still")
        return _rest(time, speed, direction), ended
    return state, ()
