"""Noise on time signals, in decibels or per cent (thesis Appendix E), and what it leaves in a phasor."""

import math

import numpy as np

from estimator.arrays import Floats


def decibels(percent: float) -> float:
    """Signal-to-noise ratio [dB] of noise whose amplitude is so many per cent of the signal's (Eq. E.1).

    Raises ValueError for a percentage that is not positive.
    """
    if not percent > 0.0:
        raise ValueError(f"noise of {percent} %: only positive noise has a signal-to-noise ratio")
    return 20.0 * math.log10(100.0 / percent)


def percent(decibels: float) -> float:
    """Amplitude of the noise in per cent of the signal's, from the signal-to-noise ratio [dB] (Eq. E.1)."""
    return float(100.0 * 10.0 ** (-decibels / 20.0))


def noisy_signal(signal: Floats, *, decibels: float, rng: np.random.Generator) -> Floats:
    """A time signal (N,) plus white Gaussian noise with that signal-to-noise ratio [dB] of rms values about the mean.

    Raises ValueError for a signal that does not vary, which has no ratio to any noise.
    """
    spread = float(np.std(signal))
    if not spread > 0.0:
        raise ValueError("a signal that does not vary has no signal-to-noise ratio")
    return np.asarray(signal + spread * percent(decibels) / 100.0 * rng.standard_normal(signal.shape))


def phasor_error(*, percent: float, samples: int) -> float:
    """Rms error of a phasor, relative to its amplitude, that white noise leaves in a least-squares fit to so many samples.

    Noise of σ = p/100·X/√2 gives each part of the phasor the variance 2σ²/N, so the error is √2·p/(100√N) [-].
    Raises ValueError for fewer than three samples.
    """
    if samples < 3:
        raise ValueError(f"{samples} samples cannot determine mean, cosine and sine: three at least")
    return math.sqrt(2.0 / samples) * percent / 100.0
