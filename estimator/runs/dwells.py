"""Dwells at constant speed: which samples of a run belong to one, where the machine sped up or slowed down between them.

Derived here: a dwell is a stretch of consecutive samples that stay near the speed at which it begins.
"""

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from estimator.arrays import Floats

DWELLS: Literal["dwells"] = "dwells"
"""Kind of a run that somebody made of samples at constant speeds."""
NEAR = 0.01
"""Part of the speed within which samples belong to one dwell [-]."""
FEWEST = 5
"""Number of consecutive samples from which on a stretch is told from a machine that passes slowly."""
MOST = 0.5
"""Part of the samples that such stretches hold where others lie between dwells; else each sample counts as a dwell [-]."""


def dwelling(speed: Floats) -> NDArray[np.bool_]:
    """Find the samples that were taken at constant speed, of samples in the order of their time.

    Samples that are means of a dwell each, a few at every speed, are all of them.

    Args:
        speed: Speeds (S,) [rad/s].

    Returns:
        Whether each sample (S,) belongs to a dwell.
    """
    stretch = np.zeros(speed.size, dtype=np.intp)
    first, number = 0, 0
    for place in range(speed.size):
        if abs(speed[place] - speed[first]) > NEAR * speed[first]:
            first, number = place, number + 1
        stretch[place] = number
    long = np.bincount(stretch, minlength=1)[stretch] >= FEWEST if speed.size else np.zeros(0, dtype=bool)
    if np.count_nonzero(long) < MOST * speed.size:
        return np.ones(speed.size, dtype=bool)
    return np.asarray(long)
