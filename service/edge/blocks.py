"""Cutting a stream of waveforms into blocks that become phasors, in bounded memory and independent of the chunks.

Blocks follow each other without a gap, from the first sample on. Each is computed only from a window of samples around it and,
with several marks per turn, from the count of the marks. The same samples therefore give the same phasors, however they are
cut into chunks and wherever reading resumes after the agent was killed.
"""

import math
from collections.abc import Iterator
from dataclasses import replace

from estimator.signal.keyphasor import ShaftAngle
from formats.wire import OVERSPEED
from service.edge.block_outcomes import (
    BlockOutcome,
    BlockSettings,
    Position,
    measured_block,
    read_angle,
    without_block,
)
from service.edge.condition import WaveformFinding
from service.edge.mark_count import ROUNDING
from service.edge.sample_window import Chunk, SampleWindow

MARGIN = 0.5
"""Waveform on each side of a block of some seconds from which its shaft angle is read, as a part of the block's length."""
MARGIN_TURNS = 3.0
"""Waveform on each side of a block of some turns from which its shaft angle is read, in turns at the lowest speed."""


class BlockStream:
    """Converter of chunks into block outcomes. position: where to resume."""

    def __init__(self, settings: BlockSettings, position: Position | None = None) -> None:
        self._settings = settings
        self._position = position
        self._window: SampleWindow | None = None

    def margin(self) -> float:
        """Return the length of the window on each side of a block [s]."""
        if self._settings.seconds is not None:
            return MARGIN * self._settings.seconds
        return MARGIN_TURNS * 60.0 / self._settings.lowest_rpm

    def first_needed(self) -> int:
        """Return the number of the first sample that must be read to resume."""
        at = self._position
        return 0 if at is None else at.segment + at.index(at.begin - self.margin())

    def feed(self, chunk: Chunk) -> Iterator[BlockOutcome]:
        """Yield the outcomes of all blocks that this chunk completes."""
        at = self._position
        goes_on = at is not None and chunk.sampling_rate == at.sampling_rate
        if at is not None and self._window is None:
            goes_on = goes_on and chunk.first == self.first_needed()
        elif self._window is not None:
            goes_on = goes_on and chunk.follows and chunk.first == self._window.end
        if at is None or not goes_on:
            yield from self.finish()
            # After a gap the number of passed marks is unknown.
            lost = at is not None and self._settings.pulses_per_turn > 1
            self._position = Position(chunk.first, 0.0, chunk.sampling_rate, chunk.anchor, chunk.anchor_ns, lost=lost)
            self._window = None
        elif chunk.anchor > at.anchor:
            self._position = replace(at, anchor=chunk.anchor, anchor_ns=chunk.anchor_ns)
        if self._window is None:
            self._window = SampleWindow(chunk)
        else:
            self._window.append(chunk)
        yield from self._work(ended=False)

    def finish(self) -> Iterator[BlockOutcome]:
        """Yield the outcomes of the remaining samples, as far as they form blocks, at the end of the waveform."""
        if self._window is not None:
            yield from self._work(ended=True)
        self._position = self._window = None

    def _work(self, *, ended: bool) -> Iterator[BlockOutcome]:
        by_seconds = self._settings.seconds is not None
        while (outcome := self._by_seconds(ended) if by_seconds else self._block_of_turns(ended)) is not None:
            self._position = outcome.position
            yield outcome
            self._samples.drop_before(self.first_needed())

    def _by_seconds(self, ended: bool) -> BlockOutcome | None:
        at, length = self._at, self._settings.seconds or 0.0
        # A multiple of the length: a sum would accumulate rounding errors.
        end = (round(at.begin / length) + 1) * length
        if end + (0.0 if ended else self.margin()) > self._at.seconds_to(self._samples.end) + ROUNDING:
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
        # The first block begins before the first pulse, which is no fault.
        if at.begin > 0.0 and missing > ROUNDING and not (ended and until < end):
            notes.append(WaveformFinding("keyphasor_gap", None, f"the angle is not known for {missing:.3g} s of the block"))
        return self._with(angle, start, begin, until, end, notes)

    def _block_of_turns(self, ended: bool) -> BlockOutcome | None:
        """Return a block from edge to edge, enlarging the window until it holds the block's last edge; None when it cannot."""
        begin, settings, known = self._at.begin, self._settings, self._at.seconds_to(self._samples.end)
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
            found = self._block_between_edges(*self._angle(begin - self.margin(), until), end)
            if isinstance(found, BlockOutcome):
                return found
            if length == longest or not complete:
                return self._without(begin, end, found)

    def _block_between_edges(
        self, angle: ShaftAngle | WaveformFinding, start: float, end: float
    ) -> BlockOutcome | WaveformFinding:
        """Return the block whose last edge lies before `end`, or why there is none yet."""
        at, turns = self._at, self._settings.turns or 0
        if isinstance(angle, WaveformFinding):
            return angle
        gap = WaveformFinding("keyphasor_gap", None, "the angle is not known")
        first, last = next((piece for piece in angle.pieces if piece[1] > at.begin + ROUNDING), (math.inf, math.inf))
        if first > end:
            return gap
        if first > at.begin + ROUNDING:  # before the first pulse nothing is wrong
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
        return measured_block(
            self._samples,
            self._at,
            self._settings,
            angle=angle,
            start=start,
            begin=begin,
            until=until,
            end=end,
            found=found,
        )

    def _without(self, begin: float, end: float, *found: WaveformFinding) -> BlockOutcome:
        return without_block(self._at, self._settings, begin, end, *found)

    def _angle(self, begin: float, end: float) -> tuple[ShaftAngle | WaveformFinding, float]:
        """Return the shaft's angle in a window, or why there is none; and the time of the window's first sample [s]."""
        angle, start, self._position = read_angle(self._samples, self._at, self._settings, begin, end)
        return angle, start

    @property
    def _at(self) -> Position:
        assert self._position is not None
        return self._position

    @property
    def _samples(self) -> SampleWindow:
        assert self._window is not None
        return self._window
