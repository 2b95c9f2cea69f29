"""Noise on time signals, in decibels or per cent (thesis Appendix E), and the error that it leaves in a phasor."""

import math

import numpy as np

from estimator.arrays import Floats


def decibels(percent: float) -> float:
    """Convert noise in per cent of the signal's amplitude to a signal-to-noise ratio (thesis Eq. E.1).

    Args:
        percent: Amplitude of the noise over the signal's [%].

    Returns:
        Signal-to-noise ratio [dB].

    Raises:
        ValueError: The percentage is not positive.
    """
    if not percent > 0.0:
        raise ValueError(f"noise of {percent} %: only positive noise has a signal-to-noise ratio")
    return 20.0 * math.log10(100.0 / percent)


def percent(decibels: float) -> float:
    """Convert a signal-to-noise ratio to noise in per cent of the signal's amplitude (thesis Eq. E.1).

    Args:
        decibels: Signal-to-noise ratio [dB].

    Returns:
        Amplitude of the noise over the signal's [%].
    """
    return float(100.0 * 10.0 ** (-decibels / 20.0))


def noisy_signal(signal: Floats, *, decibels: float, rng: np.random.Generator) -> Floats:
    """Add white Gaussian noise to a time signal (thesis Appendix E).

    Args:
        signal: Signal (N,) [any unit].
        decibels: Signal-to-noise ratio of rms values about the mean [dB].
        rng: Random generator.

    Returns:
        Noisy signal (N,) [unit of the signal].

    Raises:
        ValueError: The signal does not vary, so that it has no ratio to any noise.
    """
    spread = float(np.std(signal))
    if not spread > 0.0:
        raise ValueError("a signal that does not vary has no signal-to-noise ratio")
    return np.asarray(signal + spread * percent(decibels) / 100.0 * rng.standard_normal(signal.shape))


def phasor_error(*, percent: float, samples: int) -> float:
    """Compute the rms error that white noise leaves in the phasor of a least-squares fit.

    Noise of σ = p/100·X/√2 gives each part of the phasor the variance 2σ²/N, so the error is √2·p/(100√N).

    Args:
        percent: Amplitude p of the noise over the signal's [%].
        samples: Number N of samples.

    Returns:
        Error relative to the phasor's amplitude [-].

    Raises:
        ValueError: There are fewer than three samples.
    """
    if samples < 3:
        raise ValueError(f"{samples} samples cannot determine mean, cosine and sine: three at least")
    return math.sqrt(2.0 / samples) * percent / 100.0
