"""Coefficients that follow the speed through numbers at the same knots, evaluated together: each by itself is a trifle."""

from collections.abc import Sequence

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.bearings.mixed_coefficient import MixedCoefficient


class KnotCoefficients(Struct, frozen=True, eq=False):
    """G coefficients at S speeds, each a weighted sum of P fitted numbers.

    Attributes:
        coefficients: Indices (G,) of the coefficients among the K.
        places: Coordinates (G, P) of the numbers of each.
        weight: Weight (S, P) of each number [-].
        positive: Which are positive by nature (G,), so that the sum is of logarithms.
        scale: Value of each (G,) where the sum is zero, of one that is not positive its unit [SI].
        shared: Whether coefficients have coordinates in common, as tied ones do.
    """

    coefficients: NDArray[np.intp]
    places: NDArray[np.intp]
    weight: Floats
    positive: NDArray[np.bool_]
    scale: Floats
    shared: bool

    @classmethod
    def of(cls, each: Sequence[tuple[int, range, MixedCoefficient]]) -> "KnotCoefficients":
        """Build them from coefficients of the same weights.

        Args:
            each: Index, coordinates and curve of each, of which all curves have the same weights.

        Returns:
            The coefficients.
        """
        said = [curve.coefficient for _, _, curve in each]
        places = np.array([list(own) for _, own, _ in each], dtype=np.intp)
        return cls(
            coefficients=np.array([index for index, _, _ in each], dtype=np.intp),
            places=places,
            weight=each[0][2].weight,
            positive=np.array([one.positive for one in said]),
            scale=np.array([one.expected if one.positive else one.scale for one in said]),
            shared=np.unique(places).size < places.size,
        )

    def values(self, theta: Floats) -> Floats:
        """Compute the coefficients.

        Args:
            theta: Fit coordinates θ (n,) [-].

        Returns:
            Coefficients (S, G) [SI].
        """
        return self._values(theta, self.weight)

    def add_derivatives(self, whole: Complexes, theta: Floats, block: slice, by_coefficient: Complexes) -> None:
        """Add the derivatives of outputs by the coordinates to those of all, at some of the speeds.

        Args:
            whole: Derivatives (n, s, m) of m outputs by all coordinates, which are added to [any unit].
            theta: Fit coordinates θ (n,) [-].
            block: The s speeds.
            by_coefficient: Derivatives (K, s, m) of the outputs by all coefficients [that unit per SI].
        """
        weight = self.weight[block]
        slope = np.where(self.positive, self._values(theta, weight), self.scale)
        along = by_coefficient[self.coefficients] * slope.T[:, :, None]
        for knot, own in enumerate(self.places.T):
            if self.shared:
                np.add.at(whole, own, along * weight[:, knot, None])
            else:
                whole[own] += along * weight[:, knot, None]

    def _values(self, theta: Floats, weight: Floats) -> Floats:
        sums = weight @ theta[self.places].T
        return np.asarray(self.scale * np.where(self.positive, np.exp(np.where(self.positive, sums, 0.0)), sums))


def gathered(each: Sequence[tuple[int, range, MixedCoefficient]]) -> tuple[KnotCoefficients, ...]:
    """Return coefficients of the same weights together.

    Args:
        each: Index, coordinates and curve of each.

    Returns:
        The coefficients, those of the same weights together.
    """
    groups: dict[bytes, list[tuple[int, range, MixedCoefficient]]] = {}
    for one in each:
        groups.setdefault(one[2].weight.tobytes(), []).append(one)
    return tuple(KnotCoefficients.of(group) for group in groups.values())
