"""The coordinates in which a train is fitted, and the weak prior that keeps undetermined directions from running away.

Direct terms are fitted as ln(p / expected), so that they stay positive and a factor counts the same up and down;
cross-coupled terms as p / scale; unbalances as U / scale, real and imaginary part.
"""

from dataclasses import dataclass
from math import log
from typing import Self

import numpy as np
from numpy.typing import NDArray

from estimator.condensation import Complexes, Floats
from estimator.parameters import Quantity, Unknowns

KNOWN_SPREAD = log(10.0)
"""Prior standard deviation of the logarithm of a direct term whose nominal value the document gives: a factor of 10."""
UNKNOWN_SPREAD = log(1000.0)
"""The same where the document gives none."""
CROSS_SPREAD = 10.0
"""Prior standard deviation of a cross-coupled term in units of its element's direct terms."""
UNBALANCE_SPREAD = 1000.0
"""Prior standard deviation of an unbalance in units of its scale: enough to make the problem regular, no more."""


@dataclass(frozen=True)
class Coordinates:
    """The map between physical parameters and fit coordinates θ (K + 2P,).

    logarithmic: (K,) True for direct terms. expected, scale: (K,) in SI. unbalance_scale: [kg m].
    centre, spread: mean and standard deviation of the prior on θ. quantities: (K,) what each coefficient is; guessed: (K,)
    True for direct terms whose expected value no document gave.
    """

    logarithmic: NDArray[np.bool_]
    expected: Floats
    scale: Floats
    unbalance_scale: float
    centre: Floats
    spread: Floats
    quantities: tuple[Quantity, ...]
    guessed: NDArray[np.bool_]

    @classmethod
    def of(cls, unknown: Unknowns, *, unbalance_scale: float) -> Self:
        """Coordinates and prior for the unknowns of a train."""
        coefficients = unknown.coefficients
        direct = np.array([c.direct for c in coefficients])
        expected = np.array([c.expected for c in coefficients])
        scale = np.array([c.scale for c in coefficients])
        spread = np.array([_spread(c.direct, c.nominal) for c in coefficients])
        planes = 2 * len(unknown.unbalances)
        return cls(
            logarithmic=direct,
            expected=expected,
            scale=scale,
            unbalance_scale=unbalance_scale,
            centre=np.concatenate([np.where(direct, 0.0, expected / scale), np.zeros(planes)]),
            spread=np.concatenate([spread, np.full(planes, UNBALANCE_SPREAD)]),
            quantities=tuple(c.quantity for c in coefficients),
            guessed=np.array([c.direct and c.nominal is None for c in coefficients]),
        )

    @property
    def coefficient_count(self) -> int:
        """K."""
        return int(self.scale.size)

    def coefficients(self, theta: Floats) -> Floats:
        """Physical coefficients (K,) [SI]."""
        part = theta[: self.coefficient_count]
        exponent = np.where(self.logarithmic, part, 0.0)
        return np.where(self.logarithmic, self.expected * np.exp(exponent), self.scale * part)

    def unbalances(self, theta: Floats) -> Complexes:
        """Complex unbalances (P,) [kg m]."""
        part = theta[self.coefficient_count :].reshape(-1, 2)
        return np.asarray(self.unbalance_scale * (part[:, 0] + 1j * part[:, 1]))

    def theta(self, coefficients: Floats, unbalances: Complexes) -> Floats:
        """Fit coordinates of physical parameters. Raises ValueError for a direct term that is not positive."""
        if np.any(coefficients[self.logarithmic] <= 0):
            raise ValueError("direct stiffness and damping terms must be positive")
        positive = np.where(self.logarithmic, coefficients / np.where(self.logarithmic, self.expected, 1.0), 1.0)
        first = np.where(self.logarithmic, np.log(positive), coefficients / self.scale)
        parts = np.stack([unbalances.real, unbalances.imag], axis=-1).reshape(-1) / self.unbalance_scale
        return np.concatenate([first, parts])

    def slope(self, theta: Floats) -> Floats:
        """∂p/∂θ (K + 2P,) [SI]."""
        first = np.where(self.logarithmic, self.coefficients(theta), self.scale)
        return np.concatenate([first, np.full(theta.size - first.size, self.unbalance_scale)])


def _spread(direct: bool, nominal: float | None) -> float:
    if not direct:
        return CROSS_SPREAD
    return UNKNOWN_SPREAD if nominal is None else KNOWN_SPREAD
