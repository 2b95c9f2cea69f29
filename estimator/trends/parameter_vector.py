"""Point: one identification's values of some parameters, with their covariance."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats


@dataclass(frozen=True)
class Point:
    """One identification's values of N parameters.

    Attributes:
        names: Names of the parameters.
        value: Values (N,) [SI, logarithms of direct terms].
        covariance: Covariance (N, N) [SI²].
    """

    names: tuple[str, ...]
    value: Floats
    covariance: Floats

    def of(self, names: Sequence[str]) -> "Point":
        """Return the point for fewer parameters.

        Args:
            names: Names of the parameters to keep.

        Returns:
            The point of these.

        Raises:
            ValueError: A name is not among the parameters.
        """
        missing = [name for name in names if name not in self.names]
        if missing:
            raise ValueError(f"not among the parameters: {', '.join(missing)}")
        index = [self.names.index(name) for name in names]
        return Point(tuple(names), self.value[index], self.covariance[np.ix_(index, index)])
