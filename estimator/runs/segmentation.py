"""Segmentation of a stream of speeds into runs: beginning and end of each run-up and run-down.

A pure state machine: `advance` takes the state so far and one sample and returns the next state and the events. The state is
plain data, so that it can be stored beside the samples and a restart goes on exactly where it stopped. Sweeps are told from
noise by hysteresis that grows with the noise of the speed readings (`estimator.runs.speed_filter`).
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import msgspec
from msgspec.structs import replace

from estimator.machine.rules import Operation, SpeedRange
from estimator.runs.speed_filter import NO_READINGS, SpeedReadings, add_reading
from estimator.units import rpm_to_rad_per_s

RunKind = Literal["run-up", "run-down"]

START_SPAN = 0.05
"""Least part of the speed range that the speed must cross in one sense for a run to begin [-]."""
START_NOISE = 8.0
"""Least number of standard deviations of a speed reading that the speed must cross for a run to begin [-]."""
REVERSAL_SPAN = 0.02
"""Least part of the speed range by which the speed must come back for the run to be over [-]."""
REVERSAL_NOISE = 6.0
"""Least number of standard deviations by which the speed must come back for the run to be over [-]."""
PLATEAU_SPAN = 0.001
"""Part of the speed range up to which a change counts as standing still [-]."""
PLATEAU_NOISE = 2.0
"""Standard deviations of a speed reading up to which a change counts as standing still [-]."""
END_SPAN = 0.2
"""Part of the speed range, from the end that a sweep heads for, within which a sweep that stands still has arrived [-]."""


@dataclass(frozen=True)
class SweepLimits:
    """Limits by which sweeps of one machine are recognised.

    Attributes:
        minimum: Lower end of the speed range [rad/s].
        maximum: Upper end of the speed range [rad/s].
        stall: Time after which a sweep that stands still near its end is over [ns].
        hold: Time after which a sweep that stands still on its way is over [ns].
        gap: Length of a pause in the data that ends a run [ns].
    """

    minimum: float
    maximum: float
    stall: int = 120_000_000_000
    hold: int = 3_600_000_000_000
    gap: int = 120_000_000_000

    @classmethod
    def of(cls, speed_range: SpeedRange, operation: Operation | None = None) -> "SweepLimits":
        """Derive the limits from a machine's speed range and operation.

        Args:
            speed_range: Speed range of the machine.
            operation: Operation of the machine; None for the usual one.

        Returns:
            The limits.
        """
        given = operation or Operation()
        return cls(
            rpm_to_rad_per_s(speed_range.minimum_rpm),
            rpm_to_rad_per_s(speed_range.maximum_rpm),
            hold=round(1e9 * given.longest_hold_s),
            gap=round(1e9 * given.longest_pause_s),
        )

    @cached_property
    def least_changes(self) -> tuple[float, float, float]:
        """Return the least changes of speed that begin a run, turn it back, and do not count as standing still [rad/s]."""
        return self.span(START_SPAN), self.span(REVERSAL_SPAN), self.span(PLATEAU_SPAN)

    def span(self, part: float) -> float:
        """Return a part of the speed range.

        Args:
            part: The part [-].

        Returns:
            Difference of speed [rad/s].
        """
        return part * (self.maximum - self.minimum)


class SweepState(msgspec.Struct, frozen=True):
    """State between samples.

    Attributes:
        sweep: +1 in a run-up, -1 in a run-down, else 0.
        direction: Sense of rotation, +1 or -1.
        last_time: Time of the last believed reading [ns]; None below the speed range.
        low_speed: Lowest speed since the last run, or in a run-down the lowest so far [rad/s].
        low_time: Time when it was last held, or in a run-down first reached [ns].
        high_speed: Highest speed since the last run, or in a run-up the highest so far [rad/s].
        high_time: Time when it was last held, or in a run-up first reached [ns].
        held_time: Time when the extreme that the sweep moves towards was last held [ns].
        run_start: Beginning of the run in progress [ns].
        mark_speed: Speed at which the sweep last made progress that noise does not explain [rad/s].
        mark_time: Time of that progress [ns].
        believed_time: Time of the newest reading that counts [ns].
        believed_speed: Speed of the newest reading that counts [rad/s].
        readings: State of the speed readings.
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
        """Restore a state from plain data; fields that an older release did not have begin afresh.

        Args:
            stored: State as `msgspec.to_builtins` gives it.

        Returns:
            The state.
        """
        known = {name: stored[name] for name in cls.__struct_fields__ if name in stored}
        if known.get("sweep") and "mark_time" not in known:
            extreme = "high" if known["sweep"] > 0 else "low"
            known |= {f"mark_{what}": known.get(f"{extreme}_{what}", 0) for what in ("time", "speed")}
        return cls(**(known | {"readings": SpeedReadings(**known.get("readings", {}))}))


AT_REST = SweepState()
"""State before the first sample."""


@dataclass(frozen=True)
class RunStarted:
    """Event: a run began.

    Attributes:
        time: Time of its first sample [ns].
        kind: Kind of the run.
    """

    time: int
    kind: RunKind


@dataclass(frozen=True)
class RunEnded:
    """Event: the run in progress ended.

    Attributes:
        start: Time of its first sample [ns].
        time: Time of its last sample [ns].
        kind: Kind of the run.
        reason: Reason in words.
    """

    start: int
    time: int
    kind: RunKind
    reason: str


RunEvent = RunStarted | RunEnded


def advance(
    state: SweepState, limits: SweepLimits, *, time: int, speed: float, direction: int
) -> tuple[SweepState, tuple[RunEvent, ...]]:
    """Take one sample, later than all before it.

    Args:
        state: State so far.
        limits: Limits of the machine.
        time: Time of the sample [ns].
        speed: Spin speed [rad/s].
        direction: Sense of rotation, +1 or -1.

    Returns:
        Next state and events.
    """
    events: tuple[RunEvent, ...] = ()
    last = state.readings.last_time
    if last is not None and time - last > limits.gap:
        state, events = finish(state, limits, reason="a pause in the data")
    elif last is not None and direction != state.direction:
        state, events = finish(state, limits, reason="the sense of rotation changed")
    readings, believed = add_reading(state.readings, time=time, speed=speed)
    state = replace(state, readings=readings, direction=direction)
    if believed is None:
        return state, events
    state, more = _step(state, limits, *believed)
    return state, (*events, *more)


def finish(state: SweepState, limits: SweepLimits, *, reason: str) -> tuple[SweepState, tuple[RunEvent, ...]]:
    """End the run in progress, if there is one, at the extreme that it reached, and forget all but the noise.

    Args:
        state: State so far.
        limits: Limits of the machine.
        reason: Reason in words.

    Returns:
        Next state and events.
    """
    events: tuple[RunEvent, ...] = ()
    if state.readings.before_time is not None and state.readings.last_time is not None:
        state, events = _step(state, limits, state.readings.last_time, state.readings.last_speed)
    readings = state.readings.restarted()
    if state.sweep:
        events = (*events, _ended(state, state.high_time if state.sweep > 0 else state.low_time, reason))
    return SweepState(readings=readings), events


def thresholds(state: SweepState, limits: SweepLimits) -> tuple[float, float, float]:
    """Compute the changes of speed that begin a run, turn it back, and count as standing still.

    Args:
        state: State so far.
        limits: Limits of the machine.

    Returns:
        The three changes [rad/s].
    """
    noise = state.readings.noise
    start, reversal, still = limits.least_changes
    return max(start, START_NOISE * noise), max(reversal, REVERSAL_NOISE * noise), max(still, PLATEAU_NOISE * noise)


def _ended(state: SweepState, time: int, reason: str) -> RunEnded:
    return RunEnded(state.run_start, max(time, state.run_start), "run-up" if state.sweep > 0 else "run-down", reason)


def _step(state: SweepState, limits: SweepLimits, time: int, speed: float) -> tuple[SweepState, tuple[RunEvent, ...]]:
    """Take one believed reading."""
    if speed < limits.minimum:
        events: tuple[RunEvent, ...] = ()
        if state.sweep:
            events = (_ended(state, state.last_time or state.run_start, "the speed left the speed range"),)
        outside = SweepState(direction=state.direction, readings=state.readings)
        return replace(outside, believed_time=time, believed_speed=speed), events
    if state.last_time is None:
        state, events = _without_run(state, time, speed), ()
    elif state.sweep == 0:
        state, events = _watch(state, limits, time, speed)
    else:
        state, events = _follow(state, limits, time, speed)
    return replace(state, last_time=time, believed_time=time, believed_speed=speed), events


def _without_run(state: SweepState, time: int, speed: float) -> SweepState:
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
    """Check whether a run begins while none is in progress: it begins where the speed last stood at the extreme it now
    leaves."""
    start, reversal, still = thresholds(state, limits)
    begun = replace(state, held_time=time, mark_speed=speed, mark_time=time)
    if speed - state.low_speed >= start:
        begun = replace(begun, sweep=1, run_start=state.low_time, high_speed=speed, high_time=time)
        return begun, (RunStarted(state.low_time, "run-up"),)
    if state.high_speed - speed >= start:
        begun = replace(begun, sweep=-1, run_start=state.high_time, low_speed=speed, low_time=time)
        return begun, (RunStarted(state.high_time, "run-down"),)
    waited = time - min(state.low_time, state.high_time) > limits.stall
    if waited and not _has_left_extremes(state, speed, reversal):
        return _without_run(state, time, speed), ()  # an old extreme must not pull hours at speed into the next run
    held = replace(
        state,
        low_speed=min(speed, state.low_speed),
        low_time=time if speed <= state.low_speed + still else state.low_time,
        high_speed=max(speed, state.high_speed),
        high_time=time if speed >= state.high_speed - still else state.high_time,
    )
    return held, ()


def is_leaving(state: SweepState, limits: SweepLimits) -> bool:
    """Check whether, without a run in progress, the speed has left an extreme so far that one may be about to begin.

    Args:
        state: State so far.
        limits: Limits of the machine.

    Returns:
        Whether it has.
    """
    return state.last_time is not None and _has_left_extremes(state, state.believed_speed, thresholds(state, limits)[1])


def _has_left_extremes(state: SweepState, speed: float, reversal: float) -> bool:
    return max(speed - state.low_speed, state.high_speed - speed) >= reversal


def _follow(state: SweepState, limits: SweepLimits, time: int, speed: float) -> tuple[SweepState, tuple[RunEvent, ...]]:
    """Check whether the run in progress goes on, comes back, or stands still."""
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
        rest = _without_run(state, state.held_time, reached)
        following, started = _watch(rest, limits, time, speed)
        return following, (_ended(state, end, "the speed turned back"), *started)
    if time - state.mark_time >= (limits.stall if _arrived(state, limits, speed) else limits.hold):
        return _without_run(state, time, speed), (_ended(state, state.mark_time, "the speed stood still"),)
    return state, ()


def _arrived(state: SweepState, limits: SweepLimits, speed: float) -> bool:
    """Check whether the sweep is near the end of the speed range that it heads for.

    On its way it may stand, to soak in heat.
    """
    left = limits.maximum - speed if state.sweep > 0 else speed - limits.minimum
    return left <= limits.span(END_SPAN)
