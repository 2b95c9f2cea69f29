"""One identification's values of some parameters, with what is known of them together."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats


@dataclass(frozen=True)
class Point:
    """One identification's values of some parameters: names (N,), value (N,) and covariance (N, N)."""

    names: tuple[str, ...]
    value: Floats
    covariance: Floats

    def of(self, names: Sequence[str]) -> "Point":
        """The same for fewer parameters. Raises ValueError for a name that is not there."""
        missing = [name for name in names if name not in self.names]
        if missing:
            raise ValueError(f"not among the parameters: {', '.join(missing)}")
        index = [self.names.index(name) for name in names]
        return Point(tuple(names), self.value[index], self.covariance[np.ix_(index, index)])
