"""From probe waveforms and the angle of the shaft to 1× and 2× phasors: least squares, block by block.

x(t) = c + d τ + Re((X₁ + Y₁ τ) e^{jθ}) + Re(X₂ e^{2jθ}) with θ counted from the keyphasor's edge and τ from the middle of the
block, so that X₁ and X₂ are the phasors there, 0-to-peak. The drift d and the trend Y₁ of the 1× phasor keep a speed ramp
from biasing X₁; as odd functions of τ they cost it next to no accuracy.
"""

import math
from dataclasses import dataclass

import numpy as np

from estimator.condensation import Complexes, Floats
from estimator.keyphasor import ShaftAngle
from estimator.waveform_fault import UNUSABLE, WaveformFault, waveform_fault

ORDERS = (1, 2)
"""Multiples of the speed that are tracked."""
COLUMNS = 8
"""Real unknowns of one block."""
FEWEST_TURNS = 3.0
"""Fewer turns do not tell the trends from the orders."""
FEWEST_SAMPLES_PER_TURN = 5.0
"""Four put the 2× at half the sampling rate."""
WORST_CONDITION = 1e4
"""Largest condition number of the normal equations of equally scaled columns."""


@dataclass(frozen=True)
class Block:
    """Phasors of C channels from one block.

    time: its middle [s]. speed: there [rad/s]. turns: in the block. samples: used of each channel. phasors: (C, 2) 1× and 2×,
    0-to-peak, unit of the waveform. scatter: (C, 2) rms of the complex error of each, from the block's own residual: right
    where what the orders leave is white noise up to half the sampling rate, blind to lines near an order. Errors of the
    keyphasor, which all channels share, come on top: in 1× phase about the angle's jitter over √turns. residual: (C,) rms of
    what is left. faults: (C,). Channels with an unusable fault are not a number.
    """

    time: float
    speed: float
    turns: float
    samples: int
    phasors: Complexes
    scatter: Floats
    residual: Floats
    faults: tuple[WaveformFault | None, ...]


@dataclass(frozen=True)
class LeftOut:
    """A stretch from `start` to `end` [s] that gave no phasors, for a reason in words."""

    start: float
    end: float
    reason: str


@dataclass(frozen=True)
class OrderTracking:
    """All blocks of a waveform in order of time, and what was left out."""

    blocks: tuple[Block, ...]
    left_out: tuple[LeftOut, ...]


def track_orders(
    waveforms: Floats,
    *,
    sampling_rate: float,
    angle: ShaftAngle,
    start: float = 0.0,
    seconds: float | None = None,
    turns: int | None = None,
    rails: tuple[float, float] | None = None,
) -> OrderTracking:
    """Phasors of waveforms (C, N), in blocks of some seconds or of some turns that begin at the first edge.

    sampling_rate: [Hz]. start: instant of the first sample on the clock of `angle` [s]. rails: measuring range of all
    channels, unit of the waveforms. Raises ValueError unless exactly one of seconds and turns is given, and positive.
    """
    if waveforms.ndim != 2:
        raise ValueError(f"waveforms have the shape {waveforms.shape}: (channels, samples) is needed")
    if (seconds is None) == (turns is None):
        raise ValueError("give either the seconds or the turns of a block")
    if (seconds or turns or 0) <= 0:
        raise ValueError("a block must last longer than nothing")
    stop = start + waveforms.shape[1] / sampling_rate
    blocks: list[Block] = []
    left_out = [LeftOut(gap.start, gap.end, gap.reason) for gap in angle.gaps]
    for begin, end in angle.pieces:
        bounds = _bounds(angle, max(begin, start), min(end, stop), seconds, turns)
        for first, last in zip(bounds[:-1], bounds[1:], strict=True):
            block = _block(waveforms, sampling_rate, angle, start, float(first), float(last), rails)
            if isinstance(block, Block):
                blocks.append(block)
            else:
                left_out.append(block)
        rest = float(bounds[-1]) if bounds.size else max(begin, start)
        if min(end, stop) - rest > 1.0 / sampling_rate:
            left_out.append(LeftOut(rest, min(end, stop), "shorter than a block"))
    return OrderTracking(tuple(blocks), tuple(sorted(left_out, key=lambda one: one.start)))


def _bounds(angle: ShaftAngle, begin: float, end: float, seconds: float | None, turns: int | None) -> Floats:
    """Instants [s] between blocks; empty where not even one begins."""
    if end <= begin:
        return np.empty(0)
    if seconds is not None:
        # A last block that ends with the waveform must not be lost by rounding.
        count = math.floor((end - begin) / seconds * (1.0 + 1e-12))
        return np.asarray(np.minimum(begin + seconds * np.arange(count + 1), end))
    inside = (angle.edge_time >= begin) & (angle.edge_time <= end)
    time, turned = angle.edge_time[inside], angle.edge_angle[inside] / (2.0 * math.pi)
    # A missing edge at a bound moves the bound to the next edge.
    wanted = np.arange(turned[0], turned[-1] + 0.5, turns or 1) if turned.size else np.empty(0)
    return np.asarray(np.unique(time[np.minimum(np.searchsorted(turned, wanted - 1e-6), time.size - 1)]))


def _block(
    waveforms: Floats,
    sampling_rate: float,
    angle: ShaftAngle,
    start: float,
    begin: float,
    end: float,
    rails: tuple[float, float] | None,
) -> Block | LeftOut:
    # Samples from begin up to, and without, end; a sample on a bound must not slip by rounding.
    first, last = (max(0, math.ceil((bound - start) * sampling_rate - 1e-6)) for bound in (begin, end))
    time = np.clip(start + np.arange(first, min(last, waveforms.shape[1])) / sampling_rate, begin, end)
    at_begin, at_end = angle.at(np.array([begin, end]))
    turned = float(at_end - at_begin) / (2.0 * math.pi)
    if turned < FEWEST_TURNS - 1e-6:
        return LeftOut(begin, end, f"{turned:.2g} turns: at least {FEWEST_TURNS:g} are needed")
    per_turn = time.size / turned
    if per_turn < FEWEST_SAMPLES_PER_TURN or time.size <= 2 * COLUMNS:
        return LeftOut(begin, end, f"{time.size} samples in {turned:.3g} turns are too few")
    middle = (begin + end) / 2.0
    columns = _columns(angle.at(time), 2.0 * (time - middle) / (end - begin))
    normal = columns @ columns.T
    if np.linalg.cond(normal) > WORST_CONDITION:
        return LeftOut(begin, end, "the instants of the samples do not tell the orders apart")

    signals = np.asarray(waveforms[:, first : first + time.size], dtype=float)
    faults = tuple(waveform_fault(signal, samples_per_turn=per_turn, rails=rails) for signal in signals)
    lost = np.array([fault in UNUSABLE for fault in faults], dtype=bool)
    signals = np.where(lost[:, None], 0.0, signals) if lost.any() else signals
    signals = signals - signals.mean(axis=1, keepdims=True)
    inverse = np.linalg.inv(normal)
    coefficients = (signals @ columns.T) @ inverse
    rest = signals - coefficients @ columns
    residual = np.sqrt(np.einsum("cn,cn->c", rest, rest) / (time.size - COLUMNS))
    residual[lost] = math.nan
    phasors = np.stack([coefficients[:, 0] + 1j * coefficients[:, 1], coefficients[:, 2] + 1j * coefficients[:, 3]], axis=1)
    phasors[lost] = complex(math.nan, math.nan)
    variance = np.diag(inverse)
    spread = np.sqrt([variance[0] + variance[1], variance[2] + variance[3]])
    speed = 2.0 * math.pi * turned / (end - begin)
    return Block(middle, speed, turned, time.size, phasors, residual[:, None] * spread, residual, faults)


def _columns(angle: Floats, position: Floats) -> Floats:
    """Rows (8, N): 1× and 2× as in Re(X e^{jnθ}) = Re X cos nθ - Im X sin nθ, the trend of the 1×, mean and drift."""
    cosine, sine = np.cos(angle), np.sin(angle)
    twice_cosine, twice_sine = 2.0 * cosine * cosine - 1.0, 2.0 * sine * cosine
    rows = (cosine, -sine, twice_cosine, -twice_sine, position * cosine, -position * sine, np.ones_like(angle), position)
    return np.stack(rows)
