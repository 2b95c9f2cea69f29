"""A 1× vibration beyond the danger limit of a machine's document that a person has to act on.

It counts at running speed in SAMPLES samples one after the other, and at other speeds once it has lasted for LASTING: a
critical speed that a sweep passes is none. It stays told, through a trip and a standstill, until the machine has run below the
limit at running speed for CALM.
"""

from collections.abc import Sequence
from typing import Any, Self

import msgspec
import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from estimator.machine.document import Machine
from estimator.phasors.near_speed import near_running_speed
from estimator.runs.operating_state import Mode
from estimator.units import rpm_to_rad_per_s
from storage.encoding.sample_blocks import Samples

SAMPLES = 3
"""Samples at running speed, one after the other, that are a danger: one alone may be a disturbance of the signal."""
LASTING = 60_000_000_000
"""Time that a vibration stays beyond the limit at any speed before it is told: longer than a critical speed is passed [ns]."""

CALM = 300_000_000_000
"""Time that the machine runs below the limit before a danger is over: longer than a trip stays near running speed [ns]."""


class DangerLevel(msgspec.Struct, frozen=True, kw_only=True):
    """The largest 1× beyond the limit, as measured, both 0-to-peak [m], and when it was beyond: first and last [ns]."""

    channel: str
    amplitude: float
    limit: float
    speed: float
    """Speed at that amplitude [rad/s]."""
    first: int
    last: int


class DangerWatch(msgspec.Struct, frozen=True):
    """State between samples.

    told: what a person has to act on. exceeding: level of the samples beyond the limit that go on. at_speed: how many of these
    were at running speed. calm_since: since when all samples are below the limit at running speed, 0 without such [ns].
    """

    told: DangerLevel | None = None
    exceeding: DangerLevel | None = None
    at_speed: int = 0
    calm_since: int = 0

    @classmethod
    def restored(cls, stored: dict[str, Any] | None) -> Self:
        """Return the state from the data that `stored` gave."""
        return cls() if stored is None else msgspec.convert(stored, cls)

    def stored(self) -> dict[str, Any] | None:
        """Return the state as plain data; None where nothing is beyond the limit."""
        return None if self == type(self)() else dict(msgspec.to_builtins(self))

    def interrupted(self) -> Self:
        """Return the state after a pause in the data: what was beyond the limit before it does not go on."""
        return type(self)(self.told)

    def advance(self, level: DangerLevel, *, running: bool) -> Self:
        """Take the level of one sample, at running speed or not."""
        if level.amplitude <= level.limit:
            if self.told is None or not running:
                return type(self)(self.told)
            since = self.calm_since or level.first
            return type(self)() if level.last - since >= CALM else type(self)(self.told, calm_since=since)
        exceeding = level if self.exceeding is None else _larger(self.exceeding, level)
        at_speed = self.at_speed + 1 if running else 0
        counts = at_speed >= SAMPLES or exceeding.last - exceeding.first >= LASTING
        if not counts:
            return replace(self, exceeding=exceeding, at_speed=at_speed, calm_since=0)
        told = exceeding if self.told is None else _larger(self.told, exceeding)
        return type(self)(told, exceeding, at_speed)


def watched(watch: DangerWatch, machine: Machine, samples: Samples, modes: Sequence[Mode]) -> DangerWatch:
    """Return the state after some samples, later than all before them; those without a good phasor change nothing."""
    limit = machine.operation.vibration_danger
    if limit is None or not len(samples):
        return watch
    amplitude = np.where(samples.usable, np.abs(samples.phasor), 0.0)
    if watch == DangerWatch() and amplitude.max() <= limit:
        return watch
    running = _at_running_speed(machine, samples, modes)
    for i in np.flatnonzero(samples.usable.any(axis=1)):
        place, time = int(np.argmax(amplitude[i])), int(samples.time[i])
        level = DangerLevel(
            channel=machine.channels[place],
            amplitude=float(amplitude[i, place]),
            limit=limit,
            speed=float(samples.speed[i]),
            first=time,
            last=time,
        )
        watch = watch.advance(level, running=bool(running[i]))
    return watch


def _at_running_speed(machine: Machine, samples: Samples, modes: Sequence[Mode]) -> NDArray[np.bool_]:
    steady = np.array([mode == "at speed" for mode in modes])
    named = machine.operation.running_rpm
    return steady if named is None else steady | near_running_speed(samples.speed, rpm_to_rad_per_s(named))


def _larger(before: DangerLevel, now: DangerLevel) -> DangerLevel:
    larger = now if now.amplitude > before.amplitude else before
    return replace(larger, first=min(before.first, now.first), last=max(before.last, now.last))
