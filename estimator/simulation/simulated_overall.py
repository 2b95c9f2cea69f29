"""Overall levels of a simulated machine: what a probe's monitor shows of its whole vibration, unfiltered.

The vibration of a sample is its 1× and its 2×, as they are sent, and a rest without any order: independent normal values,
whose size is a choice of this simulation, not a measured one.
"""

import numpy as np

from estimator.arrays import Complexes, Floats

REST = 1e-6
"""Rms of the rest [m]."""
TURNS = 4
"""Turns of a sample over which the largest and the smallest displacement are looked for."""
POINTS = 64
"""Displacements per turn."""


def simulated_overall(phasors: Complexes, second: Complexes, rng: np.random.Generator) -> Floats:
    """Draw the overall levels of samples.

    Args:
        phasors: 1× phasors (S, m) [m].
        second: 2× phasors (S, m) [m].
        rng: Random generator.

    Returns:
        Levels (S, m): half of the largest less the smallest displacement over the turns of a sample [m].
    """
    turn = np.exp(2j * np.pi * np.arange(TURNS * POINTS) / POINTS)
    waves = np.real(phasors[..., None] * turn + second[..., None] * turn**2)
    waves = waves + REST * rng.standard_normal(waves.shape)
    return np.asarray(np.ptp(waves, axis=-1) / 2.0)
