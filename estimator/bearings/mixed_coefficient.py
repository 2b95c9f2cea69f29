"""Coefficient that is, at each speed, a weighted sum of fitted numbers: of logarithms where it is positive by nature."""

import numpy as np
from msgspec import Struct

from estimator.arrays import Floats
from estimator.bearings.model import ModelParameter


class MixedCoefficient(Struct, frozen=True, eq=False):
    """One coefficient at S speeds.

    Attributes:
        coefficient: The coefficient as a parameter.
        weight: Weight (S, P) of each fitted number [-].
    """

    coefficient: ModelParameter
    weight: Floats

    def values(self, fitted: Floats) -> Floats:
        """Compute the coefficient.

        Args:
            fitted: Fitted numbers (P,) [-].

        Returns:
            Coefficient (S, 1) [SI].
        """
        return self.coefficient.value(self.weight @ fitted)[:, None]

    def derivatives(self, fitted: Floats, block: slice) -> Floats:
        """Compute the derivatives of the coefficient by the fitted numbers, at some of the speeds.

        Args:
            fitted: Fitted numbers (P,) [-].
            block: The s speeds.

        Returns:
            Derivatives (s, 1, P) [SI].
        """
        weight = self.weight[block]
        slope = self.coefficient.slope(weight @ fitted)
        return np.asarray((slope[:, None] * weight)[:, None, :])
