"""Order tracking: from probe waveforms and the angle of the shaft to 1× and 2× phasors by least squares, block by block.

x(t) = c + d τ + Re((X₁ + Y₁ τ) e^{jθ}) + Re(X₂ e^{2jθ}) with θ counted from the keyphasor's edge and τ from the middle of the
block, so that X₁ and X₂ are the phasors there, 0-to-peak. The drift d and the trend Y₁ of the 1× phasor keep a speed ramp from
biasing X₁; as odd functions of τ they cost it next to no accuracy. Without them and the 2× it is the three-parameter sine fit
of IEEE Std 1057, over the shaft's angle in place of time.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.signal.keyphasor import ShaftAngle
from estimator.signal.phasor_scatter import local_variance, quantisation_error
from estimator.signal.waveform_faults import UNUSABLE, WaveformFault, waveform_fault

Rails = tuple[float, float] | None | list[tuple[float, float] | None]
"""Measuring range in the unit of the waveforms, of all channels or a list with that of each."""

ORDERS = (1, 2)
"""Multiples of the speed that are tracked."""
COLUMNS = 8
"""Number of real unknowns of one block."""
MEAN = 6
"""Place of the mean among them."""
FEWEST_TURNS = 3.0
"""Least turns in a block: fewer do not tell the trends from the orders."""
FEWEST_SAMPLES_PER_TURN = 5.0
"""Least samples in a turn: four put the 2× at half the sampling rate."""
WORST_CONDITION = 1e4
"""Largest condition number of the normal equations of equally scaled columns [-]."""


@dataclass(frozen=True)
class Block:
    """Phasors of C channels from one block; NaN for channels with an unusable fault.

    Attributes:
        time: Middle of the block [s].
        speed: Speed in the block [rad/s].
        turns: Turns in the block [-].
        samples: Number of samples used of each channel.
        phasors: Phasors (C, 2) of 1× and 2×, 0-to-peak [unit of the waveform].
        scatter: Rms of the complex error of each (C, 2) [unit of the waveform], from the block's own residual beside the order
            (`estimator/signal/phasor_scatter.py`), with the errors by the keyphasor's jitter and a converter's steps.
        residual: Rms of the residual (C,) [unit of the waveform].
        mean: Mean (C,) of each waveform in the middle of the block, without the orders [unit of the waveform].
        overall: Half (C,) of the largest less the smallest value of each waveform, unfiltered [unit of the waveform].
        faults: Fault of each of the C waveforms, or None.
    """

    time: float
    speed: float
    turns: float
    samples: int
    phasors: Complexes
    scatter: Floats
    residual: Floats
    mean: Floats
    overall: Floats
    faults: tuple[WaveformFault | None, ...]


@dataclass(frozen=True)
class LeftOut:
    """A stretch that gave no phasors.

    Attributes:
        start: Beginning [s].
        end: End [s].
        reason: Reason in words.
    """

    start: float
    end: float
    reason: str


@dataclass(frozen=True)
class OrderTracking:
    """Result of order tracking.

    Attributes:
        blocks: All blocks of a waveform in order of time.
        left_out: Stretches that were left out.
    """

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
    rails: Rails = None,
) -> OrderTracking:
    """Compute the phasors of waveforms in blocks of some seconds or of some turns that begin at the first edge.

    Args:
        waveforms: Waveforms (C, N) [any unit].
        sampling_rate: Sampling rate [Hz].
        angle: Angle of the shaft over time.
        start: Instant of the first sample on the clock of `angle` [s].
        seconds: Length of a block [s]; None to give turns.
        turns: Turns in a block; None to give seconds.
        rails: Measuring range of all channels, or of each [unit of the waveforms].

    Returns:
        Blocks, and stretches that were left out.

    Raises:
        ValueError: The waveforms are not (C, N), or not exactly one of seconds and turns is given and positive.
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
            block = track_block(
                waveforms,
                sampling_rate=sampling_rate,
                angle=angle,
                start=start,
                begin=float(first),
                end=float(last),
                rails=rails,
            )
            if isinstance(block, Block):
                blocks.append(block)
            else:
                left_out.append(block)
        rest = float(bounds[-1]) if bounds.size else max(begin, start)
        if min(end, stop) - rest > 1.0 / sampling_rate:
            left_out.append(LeftOut(rest, min(end, stop), "shorter than a block"))
    return OrderTracking(tuple(blocks), tuple(sorted(left_out, key=lambda one: one.start)))


def _bounds(angle: ShaftAngle, begin: float, end: float, seconds: float | None, turns: int | None) -> Floats:
    """Place the instants [s] between blocks; empty where not even one begins."""
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


def track_block(
    waveforms: Floats,
    *,
    sampling_rate: float,
    angle: ShaftAngle,
    begin: float,
    end: float,
    start: float = 0.0,
    rails: Rails = None,
) -> Block | LeftOut:
    """Compute the phasors of waveforms in one block by the sine fit of IEEE Std 1057 over the angle, known throughout.

    Args:
        waveforms: Waveforms (C, N) [any unit].
        sampling_rate: Sampling rate [Hz].
        angle: Angle of the shaft over time.
        begin: Beginning of the block [s].
        end: End of the block [s].
        start: Instant of the first sample on the clock of `angle` [s].
        rails: Measuring range of all channels, or of each [unit of the waveforms].

    Returns:
        The block, or the reason why it has no phasors.
    """
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

    # One layout in memory, so that sums round alike wherever the waveforms come from.
    signals = np.ascontiguousarray(waveforms[:, first : first + time.size], dtype=float)
    ranges = rails if isinstance(rails, list) else [rails] * len(signals)
    pairs = zip(signals, ranges, strict=True)
    faults = tuple(waveform_fault(signal, samples_per_turn=per_turn, rails=one) for signal, one in pairs)
    lost = np.array([fault in UNUSABLE for fault in faults], dtype=bool)
    signals = np.where(lost[:, None], 0.0, signals) if lost.any() else signals
    mean = signals.mean(axis=1)
    signals = signals - mean[:, None]
    inverse = np.linalg.inv(normal)
    coefficients = (signals @ columns.T) @ inverse
    mean = np.where(lost, math.nan, mean + coefficients[:, MEAN])
    rest = signals - coefficients @ columns
    residual = np.where(lost, math.nan, np.sqrt(np.einsum("cn,cn->c", rest, rest) / (time.size - COLUMNS)))
    phasors = np.stack([coefficients[:, 0] + 1j * coefficients[:, 1], coefficients[:, 2] + 1j * coefficients[:, 3]], axis=1)
    phasors[lost] = complex(math.nan, math.nan)
    steps = _converter_steps(signals, phasors[:, 0], residual, lost)
    scatter = np.hypot(_scatter(rest, residual, columns, np.diag(inverse), turned), steps[:, None])
    speed = 2.0 * math.pi * turned / (end - begin)
    return Block(middle, speed, turned, time.size, phasors, scatter, residual, mean, _half_range(signals, lost), faults)


def _half_range(signals: Floats, lost: NDArray[np.bool_]) -> Floats:
    """Compute half of the largest less the smallest value (C,) of each signal, NaN for lost channels."""
    return np.asarray(np.where(lost, math.nan, np.ptp(signals, axis=1) / 2.0))


def _converter_steps(signals: Floats, phasors: Complexes, residual: Floats, lost: NDArray[np.bool_]) -> Floats:
    """Compute the rms error (C,) of the 1× by the converter's steps, zero for lost channels."""
    return np.array(
        [
            quantisation_error(signal, amplitude=abs(phasor), variance=rms**2) if not gone else 0.0
            for signal, phasor, rms, gone in zip(signals, phasors, residual, lost, strict=True)
        ]
    )


def _scatter(rest: Floats, residual: Floats, columns: Floats, variance: Floats, turns: float) -> Floats:
    """Compute the rms error (C, 2) of the phasors: the noise near each order through the least squares."""
    scatter = np.empty((residual.size, len(ORDERS)))
    for order in range(len(ORDERS)):
        cosine, negative_sine = columns[2 * order], columns[2 * order + 1]
        near = local_variance(rest, angle_cosine=cosine, angle_sine=-negative_sine, turns=turns)
        spread = math.sqrt(variance[2 * order] + variance[2 * order + 1])
        scatter[:, order] = spread * (residual if near is None else np.sqrt(near))
    scatter[np.isnan(residual)] = math.nan
    return scatter


def _columns(angle: Floats, position: Floats) -> Floats:
    """Build rows (8, N) of the model: 1×, 2×, trend of the 1×, mean and drift, Re(X e^{jnθ}) = Re X cos nθ - Im X sin nθ."""
    cosine, sine = np.cos(angle), np.sin(angle)
    twice_cosine, twice_sine = 2.0 * cosine * cosine - 1.0, 2.0 * sine * cosine
    rows = (cosine, -sine, twice_cosine, -twice_sine, position * cosine, -position * sine, np.ones_like(angle), position)
    return np.stack(rows)
