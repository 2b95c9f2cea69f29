"""Angle of the shaft from a keyphasor's waveform: edges, the turns between them, missing and double pulses.

The angle counts from the edge: it is a multiple of 2π at each edge of a once-per-turn mark. Between edges it is a monotone
piecewise cubic that follows constant acceleration exactly.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
import scipy.interpolate
import scipy.ndimage
from numpy.typing import NDArray

from estimator.arrays import Floats

Edge = Literal["rising", "falling"]

LEVEL_QUANTILE = 0.002
"""Part of the samples beyond the first guess at each of the two levels [-]: rarer spikes do not move it, pulses of half a
percent of a turn are still seen.
"""
FLANK = 0.125
"""Part of the distance between both levels within which samples belong to a level [-]; those farther from both lie on
a flank."""
HYSTERESIS = 0.4
"""Hysteresis chosen from the signal, as a part of the distance between its two levels [-]."""
FEWEST_PULSES = 4
"""Least number of pulses: fewer have no intervals to compare."""
NEIGHBOURS = 9
"""Number of intervals whose median is the local interval; it follows speeds that change by up to a tenth or so in a turn."""
TOLERANCE = 0.2
"""Largest distance of an edge from its due time, as a part of the local interval [-]."""
MISSING_IN_A_ROW = 2
"""Most missing pulses in a row that are bridged; more are a gap."""
EXTRA_IN_A_ROW = 2
"""Most pulses too many between two due ones that are dropped; more are a gap."""
LARGEST_JITTER = 0.05
"""Largest random error of the edges, as a part of the interval [-]; larger ones are not those of a turning shaft."""
MAXIMUM_MARKS = 8
"""Most marks on a shaft for which undeclared ones are searched."""
UNEVEN_MARKS = 0.02
"""Least unevenness of the intervals over a turn, as a part of the turn, that shows several marks [-]."""
UNEVEN_OVER_SPREAD = 5.0
"""Least unevenness of the intervals over the spread from turn to turn that shows several marks [-]."""
LARGEST_UNKNOWN_PART = 0.1
"""Largest part of the keyphasor's samples that may be no numbers [-]; pulses that fall on them are missing ones."""
LARGEST_REPAIRED_PART = 0.2
"""Largest number of repaired pulses and gaps over that of good pulses [-]; more are no keyphasor."""


class KeyphasorError(ValueError):
    """Raised when the keyphasor gives no angle, for the reason in words."""


class NoPulses(KeyphasorError):
    """Raised when the waveform has no pulses, or too few to compare the intervals between them."""


class InconsistentIntervals(KeyphasorError):
    """Raised when the intervals between the pulses are not those of a turning shaft."""


class SeveralPulses(KeyphasorError):
    """Raised when the intervals repeat as those of several marks on the shaft do, where one was declared."""


@dataclass(frozen=True)
class Threshold:
    """A level and a hysteresis around it.

    Attributes:
        level: Level [unit of the waveform].
        hysteresis: Width of the hysteresis [unit of the waveform].
    """

    level: float
    hysteresis: float


@dataclass(frozen=True)
class Repair:
    """A pulse that was missing and bridged, or one too many and dropped.

    Attributes:
        kind: Kind of the repair.
        time: Time when the missing pulse was due, or of the dropped one [s].
    """

    kind: Literal["missing", "extra"]
    time: float


@dataclass(frozen=True)
class Gap:
    """A stretch in which the angle is not known.

    Attributes:
        start: Beginning [s].
        end: End [s].
        reason: Reason in words.
    """

    start: float
    end: float
    reason: str


@dataclass(frozen=True)
class ShaftAngle:
    """Angle of the shaft over time.

    Attributes:
        edge_time: Instants (E,) of the edges that were kept [s].
        edge_angle: Angle (E,) at each edge [rad]; the number of turns in a gap is a guess in it.
        jitter: Rms error of an edge, estimated from the edges themselves, as an angle [rad].
        repairs: Pulses bridged or dropped, in order of time.
        gaps: Stretches without an angle.
    """

    edge_time: Floats
    edge_angle: Floats
    jitter: float
    repairs: tuple[Repair, ...]
    gaps: tuple[Gap, ...]

    @property
    def pieces(self) -> tuple[tuple[float, float], ...]:
        """Return the stretches from first to last edge without a gap [s]."""
        begins = [float(self.edge_time[0]), *(gap.end for gap in self.gaps)]
        ends = [*(gap.start for gap in self.gaps), float(self.edge_time[-1])]
        return tuple((begin, end) for begin, end in zip(begins, ends, strict=True) if end > begin)

    def at(self, time: Floats) -> Floats:
        """Compute the angle at some instants.

        Source: monotone cubic of Fritsch and Carlson (1980, doi:10.1137/0717021).

        Args:
            time: Instants (...), of any shape [s].

        Returns:
            Angles (...) [rad]; NaN before the first edge, behind the last and in gaps.
        """
        return np.where(self._known(time), self._curve(time), math.nan)

    def speed(self, time: Floats) -> Floats:
        """Compute the speed at some instants: one turn's value, as noisy as the edges are.

        Source: monotone cubic of Fritsch and Carlson (1980, doi:10.1137/0717021).

        Args:
            time: Instants (...), of any shape [s].

        Returns:
            Speeds (...) [rad/s]; NaN before the first edge, behind the last and in gaps.
        """
        return np.where(self._known(time), self._curve(time, 1), math.nan)

    def _known(self, time: Floats) -> NDArray[np.bool_]:
        known = (time >= self.edge_time[0]) & (time <= self.edge_time[-1])
        for gap in self.gaps:
            known &= (time <= gap.start) | (time >= gap.end)
        return np.asarray(known)

    @cached_property
    def _curve(self) -> scipy.interpolate.CubicHermiteSpline:
        slopes = np.empty_like(self.edge_time)
        for begin, end in self.pieces:
            piece = (self.edge_time >= begin) & (self.edge_time <= end)
            slopes[piece] = monotone_slopes(self.edge_time[piece], self.edge_angle[piece])
        return scipy.interpolate.CubicHermiteSpline(self.edge_time, self.edge_angle, slopes)


def threshold_of(signal: Floats) -> Threshold:
    """Choose the threshold halfway between the two levels of a pulse waveform.

    Args:
        signal: Waveform (N,) [any unit].

    Returns:
        The threshold [unit of the waveform].

    Raises:
        NoPulses: The waveform has but one level.
    """
    signal = signal[np.isfinite(signal)]
    low, high = (float(level) for level in np.quantile(signal, (LEVEL_QUANTILE, 1.0 - LEVEL_QUANTILE)))
    if not high > low:
        raise NoPulses(f"the keyphasor stays at {low:g}: no pulses")
    # The outermost samples of the longer level reach farther into the noise; medians of the two parts do not.
    # Samples on the flanks belong to neither level.
    flank = (high - low) * FLANK
    low, high = float(np.median(signal[signal <= low + flank])), float(np.median(signal[signal >= high - flank]))
    return Threshold((low + high) / 2.0, HYSTERESIS * (high - low))


def edges(signal: Floats, *, sampling_rate: float, threshold: Threshold, edge: Edge = "rising", start: float = 0.0) -> Floats:
    """Find the instants at which a waveform crosses the threshold's level, interpolated linearly between two samples.

    A rising edge counts when the signal has been below level - hysteresis/2 before and goes above level + hysteresis/2 behind
    it; a falling edge is the mirror image.

    Args:
        signal: Waveform (N,) [any unit].
        sampling_rate: Sampling rate [Hz].
        threshold: The threshold.
        edge: Kind of the edge.
        start: Instant of the first sample [s].

    Returns:
        Instants (P,) [s].
    """
    sign = 1.0 if edge == "rising" else -1.0
    height = sign * (np.asarray(signal, dtype=float) - threshold.level)
    state = (height > threshold.hysteresis / 2.0).astype(np.int8) - (height < -threshold.hysteresis / 2.0).astype(np.int8)
    outside = np.flatnonzero(state)
    into = np.flatnonzero(np.diff(state[outside]) > 0)
    before, behind = outside[into], outside[into + 1]
    # Noise can cross the level several times on the flank; the last crossing alone would be late, the first early.
    place = np.arange(height.size)
    last_below = np.maximum.accumulate(np.where(height < 0.0, place, 0))[behind]
    first_above = np.minimum.accumulate(np.where(height >= 0.0, place, height.size - 1)[::-1])[::-1][before]
    crossing = (_crossing(height, first_above - 1) + _crossing(height, last_below)) / 2.0
    return np.asarray(start + crossing[np.isfinite(crossing)] / sampling_rate)


def _crossing(height: Floats, below: NDArray[np.intp]) -> Floats:
    """Interpolate where a straight line from sample `below` to the next one passes zero, in samples; NaN beside a gap."""
    return np.asarray(below + height[below] / (height[below] - height[below + 1]))


def monotone_slopes(time: Floats, angle: Floats) -> Floats:
    """Compute the slope at each knot of a monotone cubic through all knots.

    It is that of the parabola through the knot and its neighbours, limited so that the cubic is monotone; the limit of three
    times the smaller neighbouring slope is that of Fritsch and Carlson (1980, doi:10.1137/0717021).

    Args:
        time: Instants of the knots (E,) [s].
        angle: Angles at the knots (E,) [rad].

    Returns:
        Slopes (E,) [rad/s].
    """
    secant = np.diff(angle) / np.diff(time)
    if secant.size == 1:
        return np.repeat(secant, 2)
    before, after = np.diff(time)[:-1], np.diff(time)[1:]
    inner = (after * secant[:-1] + before * secant[1:]) / (before + after)
    first = 2.0 * secant[0] - inner[0]
    last = 2.0 * secant[-1] - inner[-1]
    slopes = np.concatenate([[first], inner, [last]])
    limit = 3.0 * np.minimum(np.concatenate([secant[:1], secant]), np.concatenate([secant, secant[-1:]]))
    return np.asarray(np.clip(slopes, 0.0, limit))


def shaft_angle(times: Floats, *, pulses_per_turn: int = 1) -> ShaftAngle:
    """Compute the angle of the shaft from the instants of all edges, missing and double pulses repaired or declared.

    With more than one mark the phase is known up to a multiple of 2π / pulses_per_turn only, as the first good edge is taken
    as angle zero, and nothing behind a gap is used. A turn with twice the marks declared cannot be told from twice the speed.
    Near standstill, where the speed changes by more than a tenth in a turn, a longer turn may pass for a missing pulse.

    Source: monotone cubic of Fritsch and Carlson (1980, doi:10.1137/0717021) through the edges.

    Args:
        times: Instants of the edges (P,), ascending [s].
        pulses_per_turn: Number of evenly spaced marks.

    Returns:
        The angle.

    Raises:
        ValueError: pulses_per_turn is below 1.
        NoPulses: There are fewer than four edges.
        SeveralPulses: An uneven pattern repeats every few edges where one mark is declared.
        InconsistentIntervals: No two intervals in a row agree, fewer than four edges are good, repairs and gaps are more than
            a fifth of them, gaps take more than half of the time, or the edges scatter by more than 5 % of the interval.
    """
    if pulses_per_turn < 1:
        raise ValueError(f"pulses_per_turn is {pulses_per_turn}: it must be 1 or more")
    if times.size < FEWEST_PULSES:
        raise NoPulses(f"{times.size} pulses: at least {FEWEST_PULSES} are needed")
    interval = np.diff(times)
    if pulses_per_turn == 1 and (marks := repeated_pattern(interval)):
        raise SeveralPulses(f"the intervals repeat every {marks} pulses: that many marks on the shaft, one is declared")
    local = scipy.ndimage.median_filter(interval, size=NEIGHBOURS, mode="mirror")
    good = np.abs(interval / local - 1.0) <= TOLERANCE
    anchors = np.flatnonzero(good[:-1] & good[1:])
    if not anchors.size:
        raise InconsistentIntervals(f"no two intervals in a row of the {interval.size} between the pulses agree")
    edges = _good_edges(times, local, anchors, may_leave_gaps=pulses_per_turn == 1)
    repairs, gaps, kept = edges.repairs, edges.gaps, edges.kept

    spacing = 2.0 * math.pi / pulses_per_turn
    edge_time, number = times[kept], np.array(edges.counts)
    whole = ShaftAngle(edge_time, spacing * number, 0.0, tuple(sorted(repairs, key=lambda one: one.time)), tuple(gaps))
    scatter = _scatter(edge_time, number)
    known = sum(end - begin for begin, end in whole.pieces)
    if known < 0.5 * (times[-1] - times[0]):
        raise InconsistentIntervals(f"the intervals fit together for {known:.3g} s of {times[-1] - times[0]:.3g} s only")
    if len(repairs) + len(gaps) > LARGEST_REPAIRED_PART * len(kept) or len(kept) < FEWEST_PULSES:
        raise InconsistentIntervals(
            f"{len(repairs)} pulses missing or too many and {len(gaps)} gaps beside {len(kept)} good pulses"
        )
    if scatter > LARGEST_JITTER:
        raise InconsistentIntervals(f"the edges scatter by {100 * scatter:.1f} % of the interval between pulses")
    return ShaftAngle(edge_time, whole.edge_angle, scatter * spacing, whole.repairs, whole.gaps)


@dataclass(frozen=True)
class _GoodEdges:
    """Edges that fit together: kept (G,) by index, counts (G,) marks passed up to each, and what was repaired or left out."""

    kept: list[int]
    counts: list[int]
    repairs: list[Repair]
    gaps: list[Gap]


def _good_edges(times: Floats, local: Floats, anchors: NDArray[np.intp], *, may_leave_gaps: bool) -> _GoodEdges:
    """Follow the edges from the first anchor on; local: (P-1,) interval expected at each edge [s]."""
    at = int(anchors[0])
    found = _GoodEdges([at], [0], [], [])
    while at < times.size - 1:
        step = _next_edge(times, at, float(local[at]))
        if step is not None:
            following, count = step
            found.repairs.extend(Repair("extra", float(time)) for time in times[at + 1 : following])
            due = np.linspace(times[at], times[following], count + 1)[1:-1]
            found.repairs.extend(Repair("missing", float(time)) for time in due)
        else:
            later = anchors[anchors > at]
            if not later.size or not may_leave_gaps:
                break
            following = int(later[0])
            # Only the phase goes on behind a gap; the count must not pass for one of neighbouring edges.
            count = max(MISSING_IN_A_ROW + 2, round(float((times[following] - times[at]) / local[at])))
            reason = "the intervals between the pulses do not fit together"
            found.gaps.append(Gap(float(times[at]), float(times[following]), reason))
        at = following
        found.kept.append(at)
        found.counts.append(found.counts[-1] + count)
    return found


def repeated_pattern(interval: Floats) -> int | None:
    """Find the number of intervals after which an uneven pattern repeats, turn after turn.

    Args:
        interval: Intervals (P,) [s].

    Returns:
        The number; None where no pattern repeats.
    """
    for marks in range(2, min(MAXIMUM_MARKS, interval.size // FEWEST_PULSES) + 1):
        # Over a whole turn about an interval the pattern averages out, and a steady change of speed, too.
        window = np.ones(marks) if marks % 2 else np.concatenate([[0.5], np.ones(marks - 1), [0.5]])
        around = np.convolve(interval, window / marks, mode="valid")
        margin = (interval.size - around.size) // 2
        part = interval[margin : margin + around.size] / (marks * around)
        turns = part[: part.size // marks * marks].reshape(-1, marks)
        if len(turns) < FEWEST_PULSES - 1:
            continue
        unevenness = float(np.ptp(turns.mean(axis=0)))
        if unevenness > max(UNEVEN_MARKS, UNEVEN_OVER_SPREAD * float(np.max(turns.std(axis=0)))):
            return marks
    return None


def read_keyphasor(
    signal: Floats,
    *,
    sampling_rate: float,
    start: float = 0.0,
    edge: Edge = "rising",
    pulses_per_turn: int = 1,
    threshold: Threshold | None = None,
) -> ShaftAngle:
    """Compute the angle of the shaft from a keyphasor's waveform.

    An edge steeper than a sample is known to half a sample only: a keyphasor wants the fastest sampling of all channels.

    Args:
        signal: Waveform (N,) [any unit].
        sampling_rate: Sampling rate [Hz].
        start: Instant of the first sample [s].
        edge: Kind of the edge.
        pulses_per_turn: Number of evenly spaced marks.
        threshold: The threshold; None to choose it from the signal.

    Returns:
        The angle.

    Raises:
        NoPulses: The waveform has no samples or no pulses, see `threshold_of` and `shaft_angle`.
        KeyphasorError: More than a tenth of the samples are not finite, or the edges give no angle, see `shaft_angle`.
    """
    if not signal.size:
        raise NoPulses("the keyphasor has no samples")
    unknown = int(np.count_nonzero(~np.isfinite(signal)))
    if unknown > LARGEST_UNKNOWN_PART * signal.size:
        raise KeyphasorError(f"{unknown} samples of the keyphasor's {signal.size} are not finite numbers")
    chosen = threshold_of(signal) if threshold is None else threshold
    times = edges(signal, sampling_rate=sampling_rate, threshold=chosen, edge=edge, start=start)
    return shaft_angle(times, pulses_per_turn=pulses_per_turn)


def _next_edge(times: Floats, at: int, local: float) -> tuple[int, int] | None:
    """Find the index of the edge that follows edge `at`, and by how many intervals; None where none lies near a due time."""
    ahead = (times[at + 1 : at + 2 + EXTRA_IN_A_ROW] - times[at]) / local
    for count in range(1, MISSING_IN_A_ROW + 2):
        away = np.abs(ahead - count)
        nearest = int(np.argmin(away))
        if away[nearest] <= TOLERANCE:
            return at + 1 + nearest, count
    return None


def _scatter(time: Floats, number: NDArray[np.int_]) -> float:
    """Estimate the rms error of an edge, part of the interval, from third divided differences of four in a row.

    They vanish for constant acceleration; independent errors add in them to √20/6.
    """
    together = (number[3:] - number[:-3]) == 3
    if not np.any(together):
        return 0.0
    first = np.diff(number) / np.diff(time)
    second = np.diff(first) / (time[2:] - time[:-2])
    third = np.diff(second) / (time[3:] - time[:-3])
    interval = (time[3:] - time[:-3]) / 3.0
    error = (6.0 / math.sqrt(20.0)) * third * interval**3
    return float(np.sqrt(np.mean(error[together] ** 2)))
