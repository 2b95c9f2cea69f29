"""Operating state of a machine: stopped, in slow roll, running up, at speed, running down, tripped; and since when.

A pure state machine on top of `estimator.runs.segmentation`: `advance` takes the state so far and one sample and returns the
next state and the events. The state is plain data, stored with the samples, so that a restart goes on exactly.

A trip is a run-down from the upper half of the speed range whose deceleration over its first tenth of that range is beyond
what the machine's document calls controlled. Without such a number it is compared with the machine's own earlier run-downs
from speed: a trip is TRIP_RATIO times as fast as their median, and the first few are never called one.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from statistics import median
from typing import Any, Literal

import msgspec
from msgspec.structs import replace

from estimator.machine.document import Machine
from estimator.runs.segmentation import (
    AT_REST,
    REVERSAL_NOISE,
    RunEnded,
    RunEvent,
    SweepLimits,
    SweepState,
    finish,
    is_leaving,
    thresholds,
)
from estimator.runs.segmentation import advance as advance_sweep
from estimator.units import rpm_to_rad_per_s

Mode = Literal["unknown", "stopped", "slow roll", "run-up", "at speed", "run-down", "trip"]

STOPPED_PART = 0.01
"""Part of its maximum speed below which a machine stands still, unless its document says otherwise [-]."""
TURNING_AGAIN = 1.5
"""Multiple of that speed above which a stopped machine turns again [-]; it must also rise by the noise that turns a sweep
back.
"""
TRIP_SPAN = 0.1
"""Part of the speed range over which the deceleration of a run-down from speed is measured [-]."""
FROM_SPEED = 0.5
"""Part of the speed range above which a run-down must begin to be one from speed [-]."""
TRIP_RATIO = 2.0
"""Multiple of the usual deceleration that is a trip, where the document does not say what is controlled [-]."""
USUAL_RUNS, FEWEST_RUNS = 9, 3
"""Number of run-downs whose median is the usual deceleration, and least number for it to be known."""


@dataclass(frozen=True)
class OperatingLimits:
    """Limits by which the states of one machine are told apart.

    Attributes:
        sweep: Limits of the segmentation.
        stopped: Speed below which the machine stands still [rad/s].
        controlled: Fastest controlled deceleration [rad/s²]; None to compare with earlier run-downs.
    """

    sweep: SweepLimits
    stopped: float
    controlled: float | None

    @classmethod
    def of(cls, machine: Machine) -> "OperatingLimits":
        """Derive the limits from a machine's document.

        Args:
            machine: The machine.

        Returns:
            The limits.
        """
        given = machine.operation
        below = given.stopped_below_rpm or STOPPED_PART * machine.speed_range.maximum_rpm
        controlled = given.controlled_deceleration_rpm_per_s
        return cls(
            SweepLimits.of(machine.speed_range, given),
            rpm_to_rad_per_s(below),
            None if controlled is None else rpm_to_rad_per_s(controlled),
        )


class OperatingState(msgspec.Struct, frozen=True):
    """State between samples.

    Attributes:
        mode: Operating mode; unknown before the first sample and after a silence.
        since: Time of the mode's beginning [ns].
        judged: Whether the run-down in progress was compared with what is controlled.
        decelerations: Decelerations of the last controlled run-downs from speed, oldest first [rad/s²].
        sweep: State of the segmentation.
    """

    mode: Mode = "unknown"
    since: int = 0
    judged: bool = False
    decelerations: tuple[float, ...] = ()
    sweep: SweepState = AT_REST

    @classmethod
    def restored(cls, stored: Mapping[str, Any]) -> "OperatingState":
        """Restore a state from plain data.

        Args:
            stored: State as `msgspec.to_builtins` gives it, by way of JSON or not.

        Returns:
            The state.
        """
        known = {name: stored[name] for name in cls.__struct_fields__ if name in stored}
        known["decelerations"] = tuple(known.get("decelerations", ()))
        known["sweep"] = SweepState.restored(known.get("sweep", {}))
        return cls(**known)


@dataclass(frozen=True)
class ModeChanged:
    """Event: the machine's mode has changed.

    Attributes:
        time: Time of the change [ns].
        mode: New mode.
        speed: Speed at that time [rad/s]; None where not known.
    """

    time: int
    mode: Mode
    speed: float | None


OperatingEvent = RunEvent | ModeChanged


def advance(
    state: OperatingState, limits: OperatingLimits, *, time: int, speed: float, direction: int
) -> tuple[OperatingState, tuple[OperatingEvent, ...]]:
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
    sweep, events = advance_sweep(state.sweep, limits.sweep, time=time, speed=speed, direction=direction)
    return _with_mode_event(replace(state, sweep=sweep), limits, events)


def silence(
    state: OperatingState, limits: OperatingLimits, *, reason: str
) -> tuple[OperatingState, tuple[OperatingEvent, ...]]:
    """End the run in progress because no samples came for a while; the mode is then unknown.

    Args:
        state: State so far.
        limits: Limits of the machine.
        reason: Reason in words.

    Returns:
        Next state and events.
    """
    last = state.sweep.readings.last_time
    sweep, events = finish(state.sweep, limits.sweep, reason=reason)
    state = replace(state, sweep=sweep)
    if state.mode == "unknown":
        return state, events
    state, changed = _changed(state, "unknown", max(state.since, last or 0), None)
    return state, (*events, *changed)


def _with_mode_event(
    state: OperatingState, limits: OperatingLimits, events: tuple[RunEvent, ...]
) -> tuple[OperatingState, tuple[OperatingEvent, ...]]:
    """Return the mode after a sample, its event behind those of its sweep."""
    told: tuple[OperatingEvent, ...] = events
    time, speed = state.sweep.believed_time, state.sweep.believed_speed
    if any(isinstance(event, RunEnded) for event in events):
        state = replace(state, judged=False)
    mode = _mode(state, limits, speed)
    if mode == "run-down" and state.mode != "trip":
        state, tripped = _judge_trip(state, limits, time, speed)
        if tripped:
            mode = "trip"
    elif mode == "run-down" and not events:
        mode = "trip"
    if mode == state.mode:
        return state, told
    began = state.sweep.run_start if state.sweep.sweep else time
    state, changed = _changed(state, mode, max(state.since, began), speed)
    return state, (*told, *changed)


def _changed(
    state: OperatingState, mode: Mode, time: int, speed: float | None
) -> tuple[OperatingState, tuple[ModeChanged, ...]]:
    return replace(state, mode=mode, since=time), (ModeChanged(time, mode, speed),)


def _mode(state: OperatingState, limits: OperatingLimits, speed: float) -> Mode:
    """Derive the mode from the speed and the sweep alone; a trip counts as a run-down."""
    if state.sweep.sweep:
        return "run-up" if state.sweep.sweep > 0 else "run-down"
    standing = limits.stopped
    if state.mode == "stopped":
        standing = max(TURNING_AGAIN * standing, standing + REVERSAL_NOISE * state.sweep.readings.noise)
    if speed < standing:
        return "stopped"
    # From below the range the machine is at speed only once it has left the lower end clearly behind and settled.
    below = state.mode in ("stopped", "slow roll")
    start = thresholds(state.sweep, limits.sweep)[0] if below else 0.0
    turning = state.mode not in ("unknown", "at speed") and is_leaving(state.sweep, limits.sweep)
    if speed < limits.sweep.minimum + start or (below and turning):
        return "slow roll"
    return state.mode if turning else "at speed"


def _judge_trip(state: OperatingState, limits: OperatingLimits, time: int, speed: float) -> tuple[OperatingState, bool]:
    """Judge once, as soon as it has covered enough, whether the run-down in progress is a trip."""
    top, sweep = state.sweep.high_speed, limits.sweep
    covered = top - speed
    if state.judged or covered < max(sweep.span(TRIP_SPAN), thresholds(state.sweep, sweep)[0]):
        return state, False
    state = replace(state, judged=True)
    if top < sweep.minimum + sweep.span(FROM_SPEED) or time <= state.sweep.run_start:
        return state, False
    deceleration = covered / ((time - state.sweep.run_start) / 1e9)
    controlled = limits.controlled
    if controlled is None and len(state.decelerations) >= FEWEST_RUNS:
        controlled = TRIP_RATIO * median(state.decelerations)
    if controlled is not None and deceleration > controlled:
        return state, True
    return replace(state, decelerations=(*state.decelerations, deceleration)[-USUAL_RUNS:]), False
