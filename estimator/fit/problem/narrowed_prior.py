"""Coordinates whose prior is narrower, for fits that are held near what is believed before they are let go."""

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from estimator.fit.problem.coordinates import Coordinates


def narrowed(coordinates: Coordinates, factor: float, which: NDArray[np.bool_] | None = None) -> Coordinates:
    """Return coordinates with a prior that is narrower by a factor.

    Args:
        coordinates: The coordinates.
        factor: Factor by which standard deviations are smaller [-].
        which: Coordinates (n,) of which they are; None for all.

    Returns:
        The coordinates.
    """
    by = np.where(np.ones(coordinates.size, dtype=bool) if which is None else which, factor, 1.0)
    calibrated = None if coordinates.calibrated is None else coordinates.calibrated * np.outer(by, by)
    return replace(coordinates, spread=coordinates.spread / by, calibrated=calibrated)
