"""A coefficient that is, at each speed, a weighted sum of fitted numbers: of logarithms where it is positive by nature."""

from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats
from estimator.bearings.model import ModelParameter


@dataclass(frozen=True)
class MixedCoefficient:
    """One coefficient at S speeds. weight: (S, P) of each fitted number."""

    coefficient: ModelParameter
    weight: Floats

    def values(self, fitted: Floats) -> Floats:
        """Return the coefficient (S, 1) [SI] of fitted numbers (P,)."""
        return self.coefficient.value(self.weight @ fitted)[:, None]

    def derivatives(self, fitted: Floats, block: slice) -> Floats:
        """Return its derivatives (s, 1, P) by the fitted numbers, at some of the speeds."""
        weight = self.weight[block]
        slope = self.coefficient.slope(weight @ fitted)
        return np.asarray((slope[:, None] * weight)[:, None, :])
