"""Shapes over speed of what coefficients deviate from their model by."""

import numpy as np

from estimator.arrays import Floats
from estimator.symmetric_eigen import symmetric_eigen

CORRELATION_LENGTH = 0.4
"""Distance over which a deviation stays alike, as a part of the speed range, where nothing else is said [-]."""
LEFT_OUT = 0.01
"""Part of a deviation's variance that its left-out shapes may hold, where nothing else is said [-]."""
GRID = 60
"""Number of points over which shapes are computed."""


class DeviationShapes:
    """Shapes of a deviation over a range of speeds, by which it is a sum of independent numbers of unit variance.

    Those of a Gaussian process of squared exponential correlation (Karhunen-Loève, by Nyström's method; Rasmussen and
    Williams, Gaussian Processes for Machine Learning, 2006, sec. 4.3).
    """

    def __init__(self, low: float, high: float, *, left_out: float = LEFT_OUT, length: float = CORRELATION_LENGTH) -> None:
        """Compute the shapes.

        Args:
            low: Lowest speed [rad/s].
            high: Highest speed [rad/s].
            left_out: Part of a deviation's variance that its left-out shapes may hold [-].
            length: Distance over which a deviation stays alike, as a part of the range [-].
        """
        self.low = low
        self.high = high
        self.length = length
        self.grid = np.linspace(0.0, 1.0, GRID)
        variance, vectors = symmetric_eigen(self._correlation(self.grid, self.grid))
        variance, vectors = variance[::-1], vectors[:, ::-1]
        held = np.cumsum(variance) / variance.sum()
        count = int(np.searchsorted(held, 1.0 - left_out)) + 1
        self.weight = vectors[:, :count] / np.sqrt(variance[:count])

    @property
    def count(self) -> int:
        """Return the number of shapes B."""
        return int(self.weight.shape[1])

    def at(self, speed: Floats) -> Floats:
        """Compute the shapes at some speeds.

        Args:
            speed: Speeds (S,) [rad/s].

        Returns:
            Shapes (S, B) [-].
        """
        place = (speed - self.low) / max(self.high - self.low, 1e-300)
        return np.asarray(self._correlation(np.clip(place, 0.0, 1.0), self.grid) @ self.weight)

    def _correlation(self, first: Floats, second: Floats) -> Floats:
        return np.asarray(np.exp(-0.5 * ((first[:, None] - second) / self.length) ** 2))
