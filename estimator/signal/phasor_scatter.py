"""Error of a block's phasor, from the block's own residual in the neighbourhood of the order.

The phasor is the mean of the waveform turned back by the shaft's angle, so its error is the residual's spectral density at the
order itself. What lies at other frequencies, such as harmonics, does not reach it; a line within a few blocks' widths (mains
hum) and errors of the shaft's angle (the keyphasor's jitter) do, and show beside the order.
"""

import math

import numpy as np
import scipy.fft

from estimator.arrays import Complexes, Floats

BINS = 16
"""Number of frequencies on each side of the order, 1/T apart for blocks of length T, that make its neighbourhood."""
FEWEST_BINS = 4
"""Least number of these frequencies; with fewer, in blocks of less than ten turns, the residual is taken to be white."""
LINE = 3.0
"""Power of the component next to the order, over the density, from which on it is a line [-]: noise does that in one of twenty
blocks.
"""
LARGEST_LEAKAGE = 2.0
"""Largest power that a line adds to the phasor, over that component's power [-]: reached for a line 0.6 bins away, below which
block and line cannot be told apart.
"""
DISTINCT_PART = 0.25
"""Largest part of a waveform's samples that differ for them to be a converter's steps [-]."""
STEP_SAMPLES = 2_000
"""Number of a waveform's samples that are searched for steps."""


def local_variance(residual: Floats, *, angle_cosine: Floats, angle_sine: Floats, turns: float) -> Floats | None:
    """Estimate the variance of white noise that would be as strong near the order as the residual is.

    Source: own derivation: median of the periodogram beside the order over that of an exponential distribution, less what a
    line near it adds.

    Args:
        residual: Residuals (C, N) of C channels [any unit].
        angle_cosine: Cosine of the order's angle (N,) [-].
        angle_sine: Sine of the order's angle (N,) [-].
        turns: Turns of the shaft in the block [-].

    Returns:
        Variance (C,) [unit of the residual squared]; None for blocks so short that the order has no neighbourhood.
    """
    bins = min(BINS, int(turns / 2.0) - 1)
    if bins < FEWEST_BINS:
        return None
    size = residual.shape[1]
    spectrum: Complexes = scipy.fft.fft(residual * (angle_cosine - 1j * angle_sine), axis=1)
    above, below = spectrum[:, 1 : bins + 1], spectrum[:, -1 : -bins - 1 : -1]
    # The fit has taken the linear trend out: 6/(πk)² of the odd half of component k.
    left = 1.0 - 3.0 / (math.pi * np.arange(2, bins + 1)) ** 2
    power = np.concatenate([np.abs(above[:, 1:]) ** 2 / left, np.abs(below[:, 1:]) ** 2 / left], axis=1)
    density = np.median(power, axis=1) / _median_of_exponential(power.shape[1])
    # Only what is even about the middle moves the phasor there; the spectrum counts time from the block's begin.
    first, second = ((-1) ** k * (above[:, k - 1] + below[:, k - 1]) / math.sqrt(2.0) for k in (1, 2))
    nearest = np.abs(first) ** 2
    line = np.minimum(_leakage(first, second), LARGEST_LEAKAGE * nearest)
    return np.asarray(np.where(nearest > LINE * density, density + line, density) / size)


def _leakage(first: Complexes, second: Complexes) -> Floats:
    """Compute the power (C,) that a single line adds to the mean, from the even components one and two bins away.

    A line ν bins away with mean s has there (-1)^k √2 s ν²/(ν² - k²): ν goes out of the two.
    """
    together = first + 4.0 * second
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = np.where(together == 0.0, math.inf, np.abs(first * second) / np.abs(together))
    return np.asarray(4.5 * mean**2)


def quantisation_error(signal: Floats, *, amplitude: float, variance: float) -> float:
    """Compute the rms error of an amplitude by a converter's steps, as the amplitude moves against the steps.

    The fundamental of a sine through a staircase with steps q is off by (2q/π) Σ (-1)^m J₁(2πmA/q)/m; its rms over A is 0.157
    q √(q/A). Noise of a third of a step smooths it out. The residual holds the steps' own noise, q²/12 (Bennett, Bell Syst.
    Tech. J. 27 (1948) 446, doi:10.1002/j.1538-7305.1948.tb01340.x), which is taken off first.

    Args:
        signal: Waveform (N,) [any unit].
        amplitude: Amplitude of the 1× [unit of the waveform].
        variance: Variance of the residual [unit of the waveform squared].

    Returns:
        Rms error [unit of the waveform]; 0 for a waveform without steps.
    """
    some = signal[:STEP_SAMPLES]
    values = np.unique(some)
    if not 2 <= values.size <= DISTINCT_PART * some.size or amplitude <= 0.0:
        return 0.0
    step = float(np.min(np.diff(values)))
    noise = max(0.0, variance - step**2 / 12.0)
    smoothed = math.exp(-2.0 * math.pi**2 * noise / step**2)
    return 0.157 * step * math.sqrt(min(1.0, step / amplitude)) * smoothed


def _median_of_exponential(count: int) -> float:
    """Compute the expected median of an even number of independent exponential values of mean 1, from the two middle ones."""
    half = count // 2
    lower = sum(1.0 / (count - place) for place in range(half))
    return lower + 0.5 / half
