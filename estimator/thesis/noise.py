"""Noise on simulated phasors: the thesis's own (Eq. 2.19-2.20) and circular complex noise.

The thesis multiplies each phasor by a real number within 1 ± N/200, so that "5 %" is 1.4 % rms, and the phase stays exact.
"""

import math
from typing import Literal

import numpy as np

from estimator.arrays import Complexes

Sharing = Literal["none", "channel", "speed", "all"]
"""Phasors that share one random number: none of them, all speeds of a channel, all channels of a speed, or all."""


def multiplicative_noise(
    response: Complexes, *, percent: float, rng: np.random.Generator, sharing: Sharing = "none"
) -> Complexes:
    """Multiply a response by 1 + (R / R_max - 1/2) N / 100, with R uniform between 0 and 1 (thesis Eq. 2.19-2.20).

    Args:
        response: Phasors (S, m) [any unit].
        percent: N [%].
        rng: Random generator.
        sharing: Phasors that share one number; the thesis does not say how many are drawn, "none" is one for each phasor.

    Returns:
        Noisy phasors (S, m) [unit of the response].

    Raises:
        ValueError: The percentage is negative.
    """
    if not percent >= 0.0:
        raise ValueError(f"noise of {percent} %: must be at least 0")
    samples, channels = response.shape
    shape = {"none": (samples, channels), "channel": (1, channels), "speed": (samples, 1), "all": (1, 1)}[sharing]
    drawn = rng.random(shape)
    # The largest of one number is that number, which would leave no noise: the range of the generator stands in for it.
    largest = drawn.max() if drawn.size > 1 else 1.0
    return np.asarray(response * (1.0 + (drawn / largest - 0.5) * percent / 100.0))


def multiplicative_rms(percent: float) -> float:
    """Compute the rms of the relative error that `multiplicative_noise` makes: N / (100 √12), for many numbers drawn.

    Args:
        percent: N [%].

    Returns:
        Rms error [-].
    """
    return percent / 100.0 / math.sqrt(12.0)


def complex_noise(response: Complexes, *, rms: float, rng: np.random.Generator) -> Complexes:
    """Add circular complex Gaussian noise to a response.

    Args:
        response: Phasors (S, m) [any unit].
        rms: Rms of the noise, relative to each phasor's amplitude [-].
        rng: Random generator.

    Returns:
        Noisy phasors (S, m) [unit of the response].

    Raises:
        ValueError: The rms is negative.
    """
    if not rms >= 0.0:
        raise ValueError(f"noise of rms {rms}: must be at least 0")
    drawn = rng.standard_normal(response.shape) + 1j * rng.standard_normal(response.shape)
    return np.asarray(response + rms / math.sqrt(2.0) * np.abs(response) * drawn)
