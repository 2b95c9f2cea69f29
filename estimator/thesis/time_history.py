"""Phasor of a time signal: the thesis's reading of one maximum and one minimum (§5.4), and a least-squares fit.

Both count from the instant of the keyphasor's pulse and give x(t) = Re(X e^{+jωt}), t = 0 at the pulse.
"""

import math

import numpy as np
import scipy.signal

from estimator.arrays import Floats

FILTER_ORDER = 2
"""Order of the Butterworth filter, which the thesis does not print."""


def band_passed(signal: Floats, *, sampling_rate: float, frequency: float, half_width: float = 2.0) -> Floats:
    """Filter a signal by a Butterworth band-pass (thesis §5.4, 5), forwards and backwards, which leaves the phase alone.

    Args:
        signal: Signal (N,) [any unit].
        sampling_rate: Sampling rate [Hz].
        frequency: Middle of the band [Hz].
        half_width: Half width of the band [Hz].

    Returns:
        Filtered signal (N,) [unit of the signal].

    Raises:
        ValueError: The band does not lie between zero and half the sampling rate.
    """
    low, high = frequency - half_width, frequency + half_width
    if not 0.0 < low < high < sampling_rate / 2:
        raise ValueError(f"the band from {low:g} to {high:g} Hz must lie between 0 and {sampling_rate / 2:g} Hz")
    sections = scipy.signal.butter(FILTER_ORDER, (low, high), btype="bandpass", fs=sampling_rate, output="sos")
    return np.asarray(scipy.signal.sosfiltfilt(sections, signal), dtype=float)


def extrema_phasor(signal: Floats, *, time: Floats, pulse: float, frequency: float) -> complex:
    """Compute a phasor from the first maximum behind the pulse and the minimum next to it (thesis Eq. 5.1-5.2).

    The delay t of the maximum means a lag, so the phasor is X e^{-2πjt/T}. Nothing is interpolated between samples, as the
    thesis does not say that it was.

    Args:
        signal: Filtered displacement (N,) [m].
        time: Instants (N,) [s].
        pulse: Instant of the keyphasor's pulse [s].
        frequency: Frequency of rotation [Hz].

    Returns:
        Phasor [m].

    Raises:
        ValueError: Less than a period and a half follow the pulse.
    """
    period = 1.0 / frequency
    first = (time >= pulse) & (time < pulse + period)
    if time[-1] < pulse + 1.5 * period or not np.any(first):
        raise ValueError(f"less than a period and a half of {period:.4g} s follow the pulse at {pulse:.4g} s")
    top = int(np.flatnonzero(first)[np.argmax(signal[first])])
    behind = (time > time[top]) & (time < time[top] + period)
    if not np.any(behind):
        behind = (time < time[top]) & (time > time[top] - period)
    size = (float(signal[top]) - float(np.min(signal[behind]))) / 2.0
    lag = 2.0 * math.pi * (float(time[top]) - pulse) / period
    return size * complex(math.cos(lag), -math.sin(lag))


def least_squares_phasor(signal: Floats, *, time: Floats, pulse: float, frequency: float) -> complex:
    """Fit mean, cosine and sine to the whole signal; no filter is needed.

    Source: own derivation: linear least squares, in place of the thesis's one maximum and one minimum (thesis §5.4).

    Args:
        signal: Displacement (N,) [m].
        time: Instants (N,) [s].
        pulse: Instant of the keyphasor's pulse [s].
        frequency: Frequency of rotation [Hz].

    Returns:
        Phasor [m].

    Raises:
        ValueError: There are fewer than three samples.
    """
    if signal.size < 3:
        raise ValueError(f"{signal.size} samples cannot determine mean, cosine and sine: three at least")
    angle = 2.0 * math.pi * frequency * (time - pulse)
    columns = np.stack([np.ones_like(angle), np.cos(angle), np.sin(angle)], axis=1)
    _, cosine, sine = np.linalg.lstsq(columns, signal, rcond=None)[0]
    return complex(cosine, -sine)
