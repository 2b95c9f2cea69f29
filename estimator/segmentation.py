"""From a stream of speeds to runs: where a run-up or a run-down begins and ends.

A pure state machine: `advance` takes the state so far and one sample and returns the next state and what happened. The
state is plain data, so that it can be stored beside the samples and a restart goes on exactly where it stopped. Sweeps are
told from noise by hysteresis that grows with the noise of the speed readings (`estimator.speed_reading`).
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import msgspec
from msgspec.structs import replace

from estimator.rules import Operation, SpeedRange
from estimator.speed_reading import NO_READINGS, SpeedReadings, take
from estimator.units import rpm_to_rad_per_s

RunKind = Literal["run-up", "run-down"]

START_SPAN = 0.05
"""Part of the speed range that the speed must cross in one sense before a run is seen to have begun, …"""
START_NOISE = 8.0
"""… and at least this many standard deviations of a speed reading."""
REVERSAL_SPAN = 0.02
"""Part of the speed range by which the speed must come back for the run to be over, …"""
REVERSAL_NOISE = 6.0
"""… and at least so many standard deviations."""
PLATEAU_SPAN = 0.001
"""Changes below this part of the speed range count as standing still, …"""
PLATEAU_NOISE = 2.0
"""… and changes below so many standard deviations."""
END_SPAN = 0.2
"""Within this part of the speed range from the end that it heads for, a sweep that stands still has arrived."""


@dataclass(frozen=True)
class SweepLimits:
    """What counts as a sweep on one machine.

    minimum, maximum: of the speed range [rad/s]. stall: a sweep that has stood still near its end for this long is over [ns].
    hold: one that has stood still on its way for this long is over [ns]. gap: a pause in the data as long as this ends a run
    [ns].
    """

    minimum: float
    maximum: float
    stall: int = 120_000_000_000
    hold: int = 3_600_000_000_000
    gap: int = 120_000_000_000

    @classmethod
    def of(cls, speed_range: SpeedRange, operation: Operation | None = None) -> "SweepLimits":
        """The limits that a machine's speed range and operation imply."""
        given = operation or Operation()
        return cls(
            rpm_to_rad_per_s(speed_range.minimum_rpm),
            rpm_to_rad_per_s(speed_range.maximum_rpm),
            hold=round(1e9 * given.longest_hold_s),
            gap=round(1e9 * given.longest_pause_s),
        )

    def span(self, part: float) -> float:
        """A part of the speed range [rad/s]."""
        return part * (self.maximum - self.minimum)


class SweepState(msgspec.Struct, frozen=True):
    """What is remembered between samples. Times [ns], speeds [rad/s]; sweep: +1 in a run-up, -1 in a run-down, else 0.

    last_time: of the last believed reading, None below the speed range. low and high: the lowest and highest speed since the
    last run, and when they were last held; in a sweep the extreme reached so far is the one it moves towards, with the time
    when it was first reached, and held_time when it was last held. mark: where the sweep last made progress that noise does
    not explain. believed: the newest reading that counts.
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
    mark_speed: float = 0.0
    mark_time: int = 0
    believed_time: int = 0
    believed_speed: float = 0.0
    readings: SpeedReadings = NO_READINGS

    @classmethod
    def restored(cls, stored: Mapping[str, Any]) -> "SweepState":
        """From what `msgspec.to_builtins` made of it; what an older release did not know of begins afresh."""
        known = {name: stored[name] for name in cls.__struct_fields__ if name in stored}
        if known.get("sweep") and "mark_time" not in known:
            extreme = "high" if known["sweep"] > 0 else "low"
            known |= {f"mark_{what}": known.get(f"{extreme}_{what}", 0) for what in ("time", "speed")}
        return cls(**(known | {"readings": SpeedReadings(**known.get("readings", {}))}))


AT_REST = SweepState()
"""Before the first sample."""


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
    events: tuple[RunEvent, ...] = ()
    last = state.readings.last_time
    if last is not None and time - last > limits.gap:
        state, events = finish(state, limits, reason="a pause in the data")
    elif last is not None and direction != state.direction:
        state, events = finish(state, limits, reason="the sense of rotation changed")
    readings, believed = take(state.readings, time=time, speed=speed)
    state = replace(state, readings=readings, direction=direction)
    if believed is None:
        return state, events
    state, more = _step(state, limits, *believed)
    return state, (*events, *more)


def finish(state: SweepState, limits: SweepLimits, *, reason: str) -> tuple[SweepState, tuple[RunEvent, ...]]:
    """End the run in progress, if there is one, at the extreme that it reached, and forget all but the noise."""
    events: tuple[RunEvent, ...] = ()
    if state.readings.before_time is not None and state.readings.last_time is not None:
        state, events = _step(state, limits, state.readings.last_time, state.readings.last_speed)
    readings = state.readings.forgotten()
    if state.sweep:
        events = (*events, _ended(state, state.high_time if state.sweep > 0 else state.low_time, reason))
    return SweepState(readings=readings), events


def thresholds(state: SweepState, limits: SweepLimits) -> tuple[float, float, float]:
    """What begins a run, what turns it back, what counts as standing still: changes of speed [rad/s]."""
    noise = state.readings.noise
    return (
        max(limits.span(START_SPAN), START_NOISE * noise),
        max(limits.span(REVERSAL_SPAN), REVERSAL_NOISE * noise),
        max(limits.span(PLATEAU_SPAN), PLATEAU_NOISE * noise),
    )


def _ended(state: SweepState, time: int, reason: str) -> RunEnded:
    return RunEnded(state.run_start, max(time, state.run_start), "run-up" if state.sweep > 0 else "run-down", reason)


def _step(state: SweepState, limits: SweepLimits, time: int, speed: float) -> tuple[SweepState, tuple[RunEvent, ...]]:
    """One believed reading."""
    if speed < limits.minimum:
        events: tuple[RunEvent, ...] = ()
        if state.sweep:
            events = (_ended(state, state.last_time or state.run_start, "the speed left the speed range"),)
        outside = SweepState(direction=state.direction, readings=state.readings)
        return replace(outside, believed_time=time, believed_speed=speed), events
    if state.last_time is None:
        state, events = _rest(state, time, speed), ()
    elif state.sweep == 0:
        state, events = _watch(state, limits, time, speed)
    else:
        state, events = _follow(state, limits, time, speed)
    return replace(state, last_time=time, believed_time=time, believed_speed=speed), events


def _rest(state: SweepState, time: int, speed: float) -> SweepState:
    return SweepState(
        direction=state.direction,
        last_time=time,
        low_speed=speed,
        low_time=time,
        high_speed=speed,
        high_time=time,
        readings=state.readings,
    )


def _watch(state: SweepState, limits: SweepLimits, time: int, speed: float) -> tuple[SweepState, tuple[RunEvent, ...]]:
    """No run in progress: does one begin? It begins where the speed last stood at the extreme it now leaves."""
    start, reversal, still = thresholds(state, limits)
    begun = replace(state, held_time=time, mark_speed=speed, mark_time=time)
    if speed - state.low_speed >= start:
        begun = replace(begun, sweep=1, run_start=state.low_time, high_speed=speed, high_time=time)
        return begun, (RunStarted(state.low_time, "run-up"),)
    if state.high_speed - speed >= start:
        begun = replace(begun, sweep=-1, run_start=state.high_time, low_speed=speed, low_time=time)
        return begun, (RunStarted(state.high_time, "run-down"),)
    waited = time - min(state.low_time, state.high_time) > limits.stall
    if waited and not _leaving(state, speed, reversal):
        return _rest(state, time, speed), ()  # an old extreme must not pull hours at speed into the next run
    held = replace(
        state,
        low_speed=min(speed, state.low_speed),
        low_time=time if speed <= state.low_speed + still else state.low_time,
        high_speed=max(speed, state.high_speed),
        high_time=time if speed >= state.high_speed - still else state.high_time,
    )
    return held, ()


def is_leaving(state: SweepState, limits: SweepLimits) -> bool:
    """Whether, without a run in progress, the speed has left an extreme so far that one may be about to begin."""
    return state.last_time is not None and _leaving(state, state.believed_speed, thresholds(state, limits)[1])


def _leaving(state: SweepState, speed: float, reversal: float) -> bool:
    return max(speed - state.low_speed, state.high_speed - speed) >= reversal


def _follow(state: SweepState, limits: SweepLimits, time: int, speed: float) -> tuple[SweepState, tuple[RunEvent, ...]]:
    """A run in progress: does it go on, come back, or stand still?"""
    _, reversal, still = thresholds(state, limits)
    reached = state.high_speed if state.sweep > 0 else state.low_speed
    progress = state.sweep * (speed - reached)
    if state.sweep * (speed - state.mark_speed) > still:
        state = replace(state, mark_speed=speed, mark_time=time)
    if progress > 0 and state.sweep > 0:
        state = replace(state, high_speed=speed, high_time=time, held_time=time)
    elif progress > 0:
        state = replace(state, low_speed=speed, low_time=time, held_time=time)
    elif -progress <= still:
        state = replace(state, held_time=time)
    end = state.high_time if state.sweep > 0 else state.low_time
    if -progress >= reversal:
        # The next run may already be under way: it began at the extreme just left.
        rest = _rest(state, state.held_time, reached)
        following, started = _watch(rest, limits, time, speed)
        return following, (_ended(state, end, "the speed turned back"), *started)
    if time - state.mark_time >= (limits.stall if _arrived(state, limits, speed) else limits.hold):
        return _rest(state, time, speed), (_ended(state, state.mark_time, "the speed stood still"),)
    return state, ()


def _arrived(state: SweepState, limits: SweepLimits, speed: float) -> bool:
    """Whether the sweep is near the end of the speed range that it heads for; on its way it may stand, to soak in heat."""
    left = limits.maximum - speed if state.sweep > 0 else speed - limits.minimum
    return left <= limits.span(END_SPAN)
