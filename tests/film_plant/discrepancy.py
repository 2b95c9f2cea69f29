"""Discrepancies of real films from any model: some per cent of coefficients, correlated over speed, their mean not zero."""

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from scipy.interpolate import CubicSpline

from tests.film_plant.arrays import Floats
from tests.film_plant.statics import Equilibrium

KNOTS = 41
"""Speeds at which a discrepancy is drawn."""
TERMS = 7
"""Terms drawn for each film: four of stiffness and three of damping, whose cross-coupled ones are equal in a film."""


@dataclass(frozen=True)
class DiscrepancySize:
    """Size of discrepancies.

    Attributes:
        stiffness_mean: Mean over all speeds and bearings of the relative discrepancy of stiffness [-].
        damping_mean: The same of damping [-].
        spread: Standard deviation around the mean [-].
        correlation: Correlation length as a part of the speed range [-].
    """

    stiffness_mean: float = 0.02
    damping_mean: float = -0.03
    spread: float = 0.03
    correlation: float = 0.4


class FilmChange(Protocol):
    """Discrepancy that makes the coefficients of films others than those of their model."""

    def applied(self, films: Equilibrium) -> Equilibrium:
        """Change the coefficients of films."""
        ...


class Discrepancy:
    """Drawn discrepancies of n films between two speeds [rad/s].

    Each term of a matrix is changed by a part of the geometric mean of the direct terms in its row and column.
    """

    def __init__(
        self, size: DiscrepancySize, bearings: int, *, slowest: float, fastest: float, rng: np.random.Generator
    ) -> None:
        place = np.linspace(0.0, 1.0, KNOTS)
        covariance = np.exp(-((place[:, None] - place) ** 2) / (2 * size.correlation**2))
        root = np.linalg.cholesky(covariance + 1e-8 * np.eye(KNOTS))
        drawn = size.spread * np.tensordot(root, rng.standard_normal((KNOTS, bearings, TERMS)), 1)
        mean = np.repeat([size.stiffness_mean, size.damping_mean], [4, 3])
        # Cross-coupled terms have no sign of their own: their mean stays zero.
        mean[[1, 2, 5]] = 0.0
        self._spline = CubicSpline(slowest + place * (fastest - slowest), drawn + mean)
        self._ends = slowest, fastest

    def at(self, speed: Floats) -> tuple[Floats, Floats]:
        """Relative discrepancies (S, n, 2, 2) of stiffness and damping at speeds (S,) [rad/s]."""
        drawn = self._spline(np.clip(speed, *self._ends))
        return drawn[..., [[0, 1], [2, 3]]], drawn[..., [[4, 5], [5, 6]]]

    def applied(self, films: Equilibrium) -> Equilibrium:
        """Change the coefficients of films."""
        stiffness, damping = self.at(films.speed)
        return replace(
            films,
            stiffness=films.stiffness + stiffness * _sizes(films.stiffness),
            damping=films.damping + damping * _sizes(films.damping),
        )


def _sizes(matrices: Floats) -> Floats:
    """Geometric means (…, 2, 2) of direct terms by row and column."""
    direct = np.sqrt(np.abs(np.stack([matrices[..., 0, 0], matrices[..., 1, 1]], axis=-1)))
    return np.asarray(direct[..., :, None] * direct[..., None, :])
