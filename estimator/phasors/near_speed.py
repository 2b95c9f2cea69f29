"""Speeds near the running speed: samples there count as taken at it."""

import numpy as np
from numpy.typing import NDArray

from estimator.arrays import Floats

NEAR = 0.02
"""Part of the running speed within which a sample counts [-]: amplitude and phase change with the speed."""


def near_running_speed(speed: Floats, running_speed: float) -> NDArray[np.bool_]:
    """Return which speeds are within NEAR of the running speed.

    Args:
        speed: Speeds (S,) [rad/s].
        running_speed: The running speed [rad/s].

    Returns:
        For each (S,) whether it is [-].
    """
    return np.asarray(np.abs(speed - running_speed) <= NEAR * running_speed)
