"""Outcomes of single blocks of a waveform: the shaft's angle around a block, its phasors, and what was found in it."""

import math
from dataclasses import dataclass, replace

from estimator.signal.keyphasor import (
    Edge,
    InconsistentIntervals,
    KeyphasorError,
    NoPulses,
    SeveralPulses,
    ShaftAngle,
    Threshold,
    read_keyphasor,
)
from estimator.signal.order_tracking import Block, LeftOut, track_block
from estimator.units import rad_per_s_to_rpm
from formats.wire import OVERSPEED
from service.edge.condition import WaveformFinding
from service.edge.mark_count import Mark, counted_from, last_mark
from service.edge.sample_window import SampleWindow

STOPPING = 1.5
"""Below this multiple of the machine's lowest speed a silent keyphasor means standstill; above, a broken keyphasor."""
KEYPHASOR_CONDITIONS: dict[type[KeyphasorError], str] = {
    NoPulses: "no_pulses",
    InconsistentIntervals: "inconsistent_pulses",
    SeveralPulses: "several_pulses",
}


@dataclass(frozen=True)
class BlockSettings:
    """Settings of the blocks. seconds or turns: length of a block. lowest, highest: lowest and highest speed of the machine
    [r/min]. rails: rails of each channel."""

    channels: tuple[str, ...]
    lowest_rpm: float
    highest_rpm: float
    rails: tuple[tuple[float, float] | None, ...]
    seconds: float | None = None
    turns: int | None = None
    edge: Edge = "rising"
    pulses_per_turn: int = 1
    threshold: Threshold | None = None


@dataclass(frozen=True)
class Position:
    """Begin of the next block, and all else that the block depends on.

    segment: number of the sample with which the unbroken waveform began. begin: beginning of the block, behind that sample
    [s]. mark: time [s] and number of a mark before it, None when the count starts anew. lost: whether the count was lost while
    turning. rpm: speed of the last block.
    """

    segment: int
    begin: float
    sampling_rate: float
    anchor: int
    anchor_ns: int
    mark: Mark | None = None
    lost: bool = False
    rpm: float = 0.0

    def index(self, instant: float) -> int:
        """Return the number, in the segment, of the first sample needed from a time [s] on."""
        return max(0, math.floor(instant * self.sampling_rate))

    def seconds_to(self, number: int) -> float:
        """Return the time of a sample, by its number in the input, behind the segment's first one [s]."""
        return float(number - self.segment) / self.sampling_rate

    def time_ns(self, instant: float) -> int:
        """Return the absolute time [ns, UTC] of a time [s] behind the segment's first sample."""
        return self.anchor_ns + round((instant - (self.anchor - self.segment) / self.sampling_rate) * 1e9)


@dataclass(frozen=True)
class BlockOutcome:
    """A processed stretch of waveform: its block, None without one; its time [ns]; the conditions found in it."""

    block: Block | None
    time_ns: int
    found: tuple[WaveformFinding, ...]
    position: Position


def read_angle(
    samples: SampleWindow, at: Position, settings: BlockSettings, begin: float, end: float
) -> tuple[ShaftAngle | WaveformFinding, float, Position]:
    """Return the shaft's angle in a window, or why there is none; the time of the window's first sample [s]; and the position,
    in which the count of the marks is lost when the mark that it counts from is not found."""
    first = max(at.index(begin), samples.first - at.segment)
    start = first / at.sampling_rate
    signal = samples.since(at.segment + first)[0, : math.ceil(end * at.sampling_rate) - first]
    try:
        angle = read_keyphasor(
            signal,
            sampling_rate=at.sampling_rate,
            start=start,
            edge=settings.edge,
            pulses_per_turn=settings.pulses_per_turn,
            threshold=settings.threshold,
        )
    except KeyphasorError as error:
        return WaveformFinding(KEYPHASOR_CONDITIONS.get(type(error), "keyphasor_not_finite"), None, str(error)), start, at
    if settings.pulses_per_turn == 1 or at.mark is None:
        return angle, start, at
    counted = counted_from(angle, at.mark, per_turn=settings.pulses_per_turn)
    return (angle, start, replace(at, mark=None, lost=True)) if counted is None else (counted, start, at)


def measured_block(
    samples: SampleWindow,
    at: Position,
    settings: BlockSettings,
    *,
    angle: ShaftAngle,
    start: float,
    begin: float,
    until: float,
    end: float,
    found: list[WaveformFinding],
) -> BlockOutcome:
    """Return the outcome with the block from `begin` to `until`; the next block begins at `end`. start: time of the angle's
    first sample; found: what was found in the waveform already."""
    values = samples.since(at.segment + round(start * at.sampling_rate))
    block = track_block(
        values[1:],
        sampling_rate=at.sampling_rate,
        angle=angle,
        start=start,
        begin=begin,
        end=until,
        rails=list(settings.rails),
    )
    if isinstance(block, LeftOut):
        return without_block(at, settings, at.begin, end, *found, WaveformFinding("too_slow", None, block.reason))
    rpm = rad_per_s_to_rpm(block.speed)
    if rpm > OVERSPEED * settings.highest_rpm:
        detail = f"{rpm:.6g} r/min by the keyphasor, the machine goes up to {settings.highest_rpm:g} r/min"
        return without_block(at, settings, at.begin, end, *found, WaveformFinding("speed_out_of_range", None, detail))
    repairs = [repair for repair in angle.repairs if begin <= repair.time < until]
    if repairs:
        kinds = " and ".join(f"{sum(r.kind == kind for r in repairs)} {kind}" for kind in ("missing", "extra"))
        found.append(WaveformFinding("pulses_repaired", None, f"{kinds} pulses in a block"))
    if at.lost:
        found.append(
            WaveformFinding("phase_reference_lost", None, "the phase counts from an unknown mark until the shaft stops")
        )
    for channel, fault in zip(settings.channels, block.faults, strict=True):
        if fault is not None:
            found.append(WaveformFinding(fault.replace(" ", "_"), channel, f"in the block of {until - begin:.3g} s"))
    position = replace(at, begin=end, mark=last_mark(angle, end, per_turn=settings.pulses_per_turn), rpm=rpm)
    return BlockOutcome(block, at.time_ns(block.time), tuple(found), position)


def without_block(at: Position, settings: BlockSettings, begin: float, end: float, *found: WaveformFinding) -> BlockOutcome:
    """Return the outcome of a stretch without a block. A silent keyphasor near standstill starts the count of marks again."""
    if any(one.name == "no_pulses" for one in found) and at.rpm < STOPPING * settings.lowest_rpm:
        at = replace(at, mark=None, lost=False)
    return BlockOutcome(None, at.time_ns((begin + end) / 2.0), found, replace(at, begin=end))
