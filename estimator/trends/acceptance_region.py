"""Acceptance region of a vibration vector in the polar plane: where the next run's lies with 95 % while nothing happens.

Prediction ellipse of one further observation of a normal vector of two components, from n earlier ones (Hotelling's T², Ann.
Math. Stat. 2 (1931) 360, doi:10.1214/aoms/1177732979): the next vector is within it where
(x - x̄)ᵀ S⁻¹ (x - x̄) ≤ 2 (n - 1)(n + 1) / (n (n - 2)) F(2, n - 2).
"""

import math
from dataclasses import dataclass

import numpy as np
import scipy.special

from estimator.arrays import Complexes

FEWEST = 3
"""Least number of vectors: two have no scatter across the line between them."""
PART = 0.95
"""Part of the next vectors that lies within [-]."""
LEAST_SCATTER = 2e-4
"""Least standard deviation, of the mean's size [-]: a source that rounds its values has no scatter at all."""


@dataclass(frozen=True)
class AcceptanceRegion:
    """Ellipse in the complex plane.

    Attributes:
        centre: Its middle [unit of the vectors].
        semi_major: Semi-major axis [unit of the vectors].
        semi_minor: Semi-minor axis [unit of the vectors].
        inclination: Angle of the major axis from the real one, in (-π/2, π/2] [rad].
    """

    centre: complex
    semi_major: float
    semi_minor: float
    inclination: float

    def holds(self, vector: complex) -> bool:
        """Check whether a vector lies within.

        Args:
            vector: The vector [unit of the region].

        Returns:
            Whether it does.
        """
        turned = (vector - self.centre) * complex(math.cos(self.inclination), -math.sin(self.inclination))
        return (turned.real / self.semi_major) ** 2 + (turned.imag / self.semi_minor) ** 2 <= 1.0


def acceptance_region(vectors: Complexes) -> AcceptanceRegion | None:
    """Compute the region from the vectors of n runs to which nothing has happened (Hotelling 1931).

    Source: Hotelling, Ann. Math. Stat. 2 (1931) 360, doi:10.1214/aoms/1177732979.

    Args:
        vectors: Vectors (n,) [any unit].

    Returns:
        Region in the same unit; None for fewer than FEWEST vectors, or where all are zero.
    """
    count = len(vectors)
    if count < FEWEST:
        return None
    centre = complex(np.mean(vectors))
    rest = vectors - centre
    variance, axes = np.linalg.eigh(np.cov(np.stack([rest.real, rest.imag])))
    variance = np.maximum(variance, (LEAST_SCATTER * abs(centre)) ** 2)
    if not variance[0] > 0.0:
        return None
    reach = math.sqrt(2.0 * (count - 1) * (count + 1) / (count * (count - 2)) * _f_quantile(count - 2))
    inclination = math.atan2(axes[1, 1], axes[0, 1])
    turns = math.ceil(inclination / math.pi - 0.5)
    return AcceptanceRegion(
        centre, reach * math.sqrt(variance[1]), reach * math.sqrt(variance[0]), inclination - turns * math.pi
    )


def _f_quantile(freedom: int) -> float:
    """Return the quantile of F(2, freedom) [-]."""
    return float(scipy.special.fdtri(2.0, float(freedom), PART))
