"""Waveforms as they come, cut into blocks that become phasors: bounded memory, and nothing depends on how they come.

Blocks follow each other without a hole, from the first sample on. Each is worked out from a window of samples around it and
from nothing else (with several marks per turn: and from the count of the marks), so that the same samples give the same
phasors however they are cut into chunks, and wherever reading begins again after the agent was killed.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from estimator.condensation import Floats
from estimator.keyphasor import (
    Edge,
    InconsistentIntervals,
    KeyphasorError,
    NoPulses,
    SeveralPulses,
    ShaftAngle,
    Threshold,
    read_keyphasor,
)
from estimator.order_tracking import Block, LeftOut, track_block
from estimator.units import rad_per_s_to_rpm
from service.edge.condition import WaveformFinding
from service.wire import OVERSPEED

MARGIN = 0.5
"""Waveform on each side of a block of some seconds from which its shaft angle is read, part of the block's length."""
MARGIN_TURNS = 3.0
"""The same of a block of some turns, at the machine's lowest speed."""
SAME_MARK = 0.2
"""How far from its time a mark is still the same [part of the interval between marks]."""
STOPPING = 1.5
"""Below this multiple of the machine's lowest speed a keyphasor that falls silent means standstill; above, a broken one."""
ROUNDING = 1e-9
"""Of instants [s]."""

KEYPHASOR_CONDITIONS: dict[type[KeyphasorError], str] = {
    NoPulses: "no_pulses",
    InconsistentIntervals: "inconsistent_pulses",
    SeveralPulses: "several_pulses",
}


@dataclass(frozen=True)
class Chunk:
    """Consecutive samples of the keyphasor and the channels.

    first: number of the first one in its input. values: (1 + C, N), the keyphasor's first. sampling_rate: [Hz]. Sample
    `anchor` was taken at `anchor_ns` [ns, UTC]. follows: whether it goes on where the chunk before ended, if the numbers do.
    """

    first: int
    values: Floats
    sampling_rate: float
    anchor: int
    anchor_ns: int
    follows: bool = True


@dataclass(frozen=True)
class BlockSettings:
    """How blocks are made. seconds or turns: of a block. lowest, highest: of the machine [rpm]. rails: of each channel."""

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
    """Where the next block begins, and all else that it depends on.

    segment: number of the sample with which the unbroken waveform began. begin: of the block, behind that sample [s]. mark:
    instant [s] and number of a mark before it, None where the count begins anew. lost: whether the count was lost while
    turning. rpm: speed of the last block.
    """

    segment: int
    begin: float
    sampling_rate: float
    anchor: int
    anchor_ns: int
    mark: tuple[float, int] | None = None
    lost: bool = False
    rpm: float = 0.0


@dataclass(frozen=True)
class BlockOutcome:
    """A stretch of waveform that was worked off: its block, None if it gave none; its time [ns]; what was wrong with it."""

    block: Block | None
    time_ns: int
    found: tuple[WaveformFinding, ...]
    position: Position


class BlockStream:
    """Takes chunks, gives outcomes. position: where to go on."""

    def __init__(self, settings: BlockSettings, position: Position | None = None) -> None:
        self._settings = settings
        self._position = position
        self._first = 0
        self._values: Floats | None = None

    def margin(self) -> float:
        """Length of the window on each side of a block [s]."""
        if self._settings.seconds is not None:
            return MARGIN * self._settings.seconds
        return MARGIN_TURNS * 60.0 / self._settings.lowest_rpm

    def first_needed(self) -> int:
        """Number of the first sample that must be read to go on."""
        at = self._position
        return 0 if at is None else at.segment + self._index(at.begin - self.margin())

    def feed(self, chunk: Chunk) -> Iterator[BlockOutcome]:
        """Everything that can be worked off with this chunk."""
        at = self._position
        goes_on = at is not None and chunk.sampling_rate == at.sampling_rate
        if at is not None and self._values is None:
            goes_on = goes_on and chunk.first == self.first_needed()
        elif self._values is not None:
            goes_on = goes_on and chunk.follows and chunk.first == self._first + self._values.shape[1]
        if at is None or not goes_on:
            yield from self.finish()
            # Behind a hole nobody knows how many marks have passed.
            lost = at is not None and self._settings.pulses_per_turn > 1
            self._position = Position(chunk.first, 0.0, chunk.sampling_rate, chunk.anchor, chunk.anchor_ns, lost=lost)
            self._values = None
        elif chunk.anchor > at.anchor:
            self._position = replace(at, anchor=chunk.anchor, anchor_ns=chunk.anchor_ns)
        if self._values is None:
            self._first, self._values = chunk.first, np.ascontiguousarray(chunk.values)
        else:
            self._values = np.concatenate([self._values, np.ascontiguousarray(chunk.values)], axis=1)
        yield from self._work(ended=False)

    def finish(self) -> Iterator[BlockOutcome]:
        """Nothing follows any more: what is left over is worked off as far as it makes blocks."""
        if self._values is not None:
            yield from self._work(ended=True)
        self._position = self._values = None

    def _work(self, *, ended: bool) -> Iterator[BlockOutcome]:
        by_seconds = self._settings.seconds is not None
        while (outcome := self._by_seconds(ended) if by_seconds else self._by_turns(ended)) is not None:
            self._position = outcome.position
            yield outcome
            self._forget()

    def _by_seconds(self, ended: bool) -> BlockOutcome | None:
        at, length = self._at, self._settings.seconds or 0.0
        # A multiple of the length, not a sum of many.
        end = (round(at.begin / length) + 1) * length
        if end + (0.0 if ended else self.margin()) > self._known() + ROUNDING:
            return None
        angle, start = self._angle(at.begin - self.margin(), end + self.margin())
        if isinstance(angle, WaveformFinding):
            return self._without(at.begin, end, angle)
        inside = [(max(begin, at.begin), min(until, end)) for begin, until in angle.pieces]
        begin, until = max(inside, key=lambda one: one[1] - one[0])
        if until <= begin:
            return self._without(at.begin, end, WaveformFinding("keyphasor_gap", None, "the angle is not known in the block"))
        notes = []
        missing = (end - at.begin) - (until - begin)
        # The first block holds the first pulse; nothing is wrong with that.
        if at.begin > 0.0 and missing > ROUNDING and not (ended and until < end):
            notes.append(WaveformFinding("keyphasor_gap", None, f"the angle is not known for {missing:.3g} s of the block"))
        return self._with(angle, start, begin, until, end, notes)

    def _by_turns(self, ended: bool) -> BlockOutcome | None:
        """Blocks from edge to edge; the window grows until the block's last edge is in it."""
        begin, settings, known = self._at.begin, self._settings, self._known()
        turns = settings.turns or 0
        shortest, longest = turns * 60.0 / settings.highest_rpm, turns * 60.0 / settings.lowest_rpm
        length = shortest
        while True:
            length = min(2.0 * length, longest)
            until = begin + length + self.margin()
            complete = until <= known + ROUNDING
            if not complete and (not ended or known - begin < shortest / OVERSPEED):
                return None
            end = min(begin + length, known)
            found = self._from_edge_to_edge(*self._angle(begin - self.margin(), until), end)
            if isinstance(found, BlockOutcome):
                return found
            if length == longest or not complete:
                return self._without(begin, end, found)

    def _from_edge_to_edge(
        self, angle: ShaftAngle | WaveformFinding, start: float, end: float
    ) -> BlockOutcome | WaveformFinding:
        """The block whose last edge lies before `end`, or why there is none yet."""
        at, turns = self._at, self._settings.turns or 0
        if isinstance(angle, WaveformFinding):
            return angle
        gap = WaveformFinding("keyphasor_gap", None, "the angle is not known")
        first, last = next((piece for piece in angle.pieces if piece[1] > at.begin + ROUNDING), (math.inf, math.inf))
        if first > end:
            return gap
        if first > at.begin + ROUNDING:  # up to the first pulse nothing is wrong
            return self._without(at.begin, first, *([gap] if at.begin > 0.0 else []))
        inside = (angle.edge_time >= at.begin - ROUNDING) & (angle.edge_time <= last + ROUNDING)
        time, turned = angle.edge_time[inside], angle.edge_angle[inside] / (2.0 * math.pi)
        enough = time[turned - turned[0] >= turns - 1e-6]
        if enough.size and enough[0] <= end + ROUNDING:
            return self._with(angle, start, float(time[0]), float(enough[0]), float(enough[0]), [])
        if last < min(end, angle.edge_time[-1]) - ROUNDING:
            return self._without(at.begin, last, gap)
        return WaveformFinding("too_slow", None, f"no {turns} turns in {end - at.begin:.3g} s")

    def _with(
        self, angle: ShaftAngle, start: float, begin: float, until: float, end: float, found: list[WaveformFinding]
    ) -> BlockOutcome:
        """The block from `begin` to `until`; the next one begins at `end`."""
        at, settings = self._at, self._settings
        values = self._window(start)
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
            return self._without(at.begin, end, *found, WaveformFinding("too_slow", None, block.reason))
        rpm = rad_per_s_to_rpm(block.speed)
        if rpm > OVERSPEED * settings.highest_rpm:
            detail = f"{rpm:.6g} rpm by the keyphasor, the machine goes up to {settings.highest_rpm:g} rpm"
            return self._without(at.begin, end, *found, WaveformFinding("speed_out_of_range", None, detail))
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
        position = replace(at, begin=end, mark=self._mark(angle, end), rpm=rpm)
        return BlockOutcome(block, self._time_ns(block.time), tuple(found), position)

    def _without(self, begin: float, end: float, *found: WaveformFinding) -> BlockOutcome:
        at = self._at
        if any(one.name == "no_pulses" for one in found) and at.rpm < STOPPING * self._settings.lowest_rpm:
            at = replace(at, mark=None, lost=False)
        return BlockOutcome(None, self._time_ns((begin + end) / 2.0), found, replace(at, begin=end))

    def _angle(self, begin: float, end: float) -> tuple[ShaftAngle | WaveformFinding, float]:
        """The shaft's angle in a window, or why there is none; and the instant of the window's first sample [s]."""
        at, settings = self._at, self._settings
        first = max(self._index(begin), self._first - at.segment)
        start = first / at.sampling_rate
        signal = self._window(start)[0, : math.ceil(end * at.sampling_rate) - first]
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
            return WaveformFinding(KEYPHASOR_CONDITIONS.get(type(error), "keyphasor_not_finite"), None, str(error)), start
        return self._counted(angle), start

    def _counted(self, angle: ShaftAngle) -> ShaftAngle:
        """With several marks per turn: the angle counted from the same mark as before."""
        at, per_turn = self._at, self._settings.pulses_per_turn
        if per_turn == 1 or at.mark is None:
            return angle
        time, number = at.mark
        nearest = int(np.argmin(np.abs(angle.edge_time - time)))
        spacing = 2.0 * math.pi / per_turn
        interval = spacing / float(angle.speed(angle.edge_time[nearest]))
        if abs(float(angle.edge_time[nearest]) - time) > SAME_MARK * interval:
            self._position = replace(at, mark=None, lost=True)
            return angle
        ahead = number - round(float(angle.edge_angle[nearest]) / spacing)
        return replace(angle, edge_angle=angle.edge_angle + spacing * ahead)

    def _mark(self, angle: ShaftAngle, before: float) -> tuple[float, int] | None:
        """The last edge up to an instant, and its number in the turn."""
        per_turn = self._settings.pulses_per_turn
        known = np.flatnonzero(angle.edge_time <= before + ROUNDING)
        if per_turn == 1 or not known.size:
            return None
        number = round(float(angle.edge_angle[known[-1]]) * per_turn / (2.0 * math.pi))
        return float(angle.edge_time[known[-1]]), number % per_turn

    @property
    def _at(self) -> Position:
        assert self._position is not None
        return self._position

    def _known(self) -> float:
        """End of the samples at hand, behind the segment's begin [s]."""
        assert self._values is not None
        return float(self._first - self._at.segment + self._values.shape[1]) / self._at.sampling_rate

    def _index(self, instant: float) -> int:
        """Number, in the segment, of the first sample needed from an instant [s] on."""
        assert self._position is not None
        return max(0, math.floor(instant * self._position.sampling_rate))

    def _window(self, start: float) -> Floats:
        """Samples from an instant [s] on."""
        assert self._values is not None
        return self._values[:, round(start * self._at.sampling_rate) - (self._first - self._at.segment) :]

    def _forget(self) -> None:
        """Samples before the next block's window."""
        assert self._values is not None
        needless = self.first_needed() - self._first
        if needless > 0:
            self._values, self._first = self._values[:, needless:].copy(), self._first + needless

    def _time_ns(self, instant: float) -> int:
        at = self._at
        return at.anchor_ns + round((instant - (at.anchor - at.segment) / at.sampling_rate) * 1e9)
