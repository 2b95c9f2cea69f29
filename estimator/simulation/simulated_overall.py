"""Overall levels of a simulated machine: what a probe's monitor shows of its whole vibration, unfiltered.

The vibration of a sample is its 1×, as it is sent, a 2× of a stated part of it that no source sends, as a shaft that is not
round or not straight leaves one, and a rest without any order: independent normal values. Both are choices of this simulation,
not measured ones.
"""

import numpy as np

from estimator.arrays import Complexes, Floats

SECOND_PART = 0.1
"""The 2× over the 1× [-]."""
REST = 1e-6
"""Rms of the rest [m]."""
TURNS = 4
"""Turns of a sample over which the largest and the smallest displacement are looked for."""
POINTS = 64
"""Displacements per turn."""


def simulated_overall(phasors: Complexes, rng: np.random.Generator) -> Floats:
    """Draw the overall levels of samples.

    Args:
        phasors: 1× phasors (S, m) [m].
        rng: Random generator.

    Returns:
        Levels (S, m): half of the largest less the smallest displacement over the turns of a sample [m].
    """
    turn = np.exp(2j * np.pi * np.arange(TURNS * POINTS) / POINTS)
    second = SECOND_PART * np.abs(phasors) * np.exp(2j * np.pi * rng.random(phasors.shape[1]))
    waves = np.real(phasors[..., None] * turn + second[..., None] * turn**2)
    waves = waves + REST * rng.standard_normal(waves.shape)
    return np.asarray(np.ptp(waves, axis=-1) / 2.0)
