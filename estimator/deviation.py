"""Deviation of every parameter of an identification from the machine's baseline, and of each element as a whole.

A change is measured in the parameter's own size: of a direct term it is that of its logarithm, of a cross-coupled one it is
part of the direct terms beside it, of an unbalance the vector's change as part of its magnitude. Its variance is that of the
fit, of the baseline's mean and of the run-to-run scatter. An element's distance is Mahalanobis's (1936), with these
variances and the fits' correlations. Scatter that is estimated makes the tails heavier than χ²: t for one number, F with the
first two moments matched for several, both with the scatter's degrees of freedom over its part of the variance. These are
fewer than Satterthwaite's (1946, doi:10.2307/3002019), which divide by the square of that part and hold in the middle of the
distribution, but not in its tails, where alerts begin.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby

import numpy as np
import scipy.special

from estimator.arrays import Floats
from estimator.between_run_scatter import between_run_scatter
from estimator.parameter_description import describe, is_direct
from estimator.point import Point

LARGEST_FREEDOM = 1e6
"""Degrees of freedom beyond which the scatter counts as known."""
CONFIDENCE = 0.95
"""Of the intervals."""


@dataclass(frozen=True)
class ParameterDeviation:
    """How far one parameter is from its baseline.

    change: part of its baseline value, of the direct terms beside a cross-coupled one, or of an unbalance's magnitude, there
    never negative; lower, upper: its 95 % interval. sigma: in standard deviations, with sign; of a complex one the distance
    of both components. probability: of one as large, either way, while nothing has changed. vector: of a complex one the
    change itself [SI]: an unbalance that came on top of the baseline's.
    """

    name: str
    element: str
    change: float
    lower: float
    upper: float
    sigma: float
    degrees_of_freedom: float
    probability: float
    vector: complex | None = None


@dataclass(frozen=True)
class ElementDistance:
    """How far all parameters of an element have moved together.

    names: of the real coordinates. distance: Mahalanobis's [-], about the root of their number while nothing has changed.
    degrees_of_freedom: with which the scatter in it is known. probability: of such a distance or a larger one by chance.
    """

    element: str
    names: tuple[str, ...]
    distance: float
    degrees_of_freedom: float
    probability: float


@dataclass(frozen=True)
class Deviations:
    """Of all parameters that the baseline and the identification determine, in the identification's order."""

    parameters: tuple[ParameterDeviation, ...]
    elements: tuple[ElementDistance, ...]


@dataclass(frozen=True)
class Whitening:
    """What changes of N coordinates are measured by, from a baseline of n runs.

    centre: (N,) mean of the baseline. size: (N,) unit of the changes, see `between_run_scatter`. scatter: (N,) run-to-run
    variance of the changes [-]. own: (N, N) covariance of the baseline's mean by the fits' errors alone [-].
    """

    names: tuple[str, ...]
    count: int
    centre: Floats
    size: Floats
    scatter: Floats
    own: Floats
    degrees_of_freedom: Floats

    @classmethod
    def of(cls, baseline: Sequence[Point], names: Sequence[str]) -> "Whitening":
        """From a baseline's points, for some of their coordinates. Raises ValueError for an empty one or unknown names."""
        points = [point.of(names) for point in baseline]
        found = between_run_scatter(points)
        covariance = np.mean([point.covariance for point in points], axis=0)
        return cls(
            names=tuple(names),
            count=len(points),
            centre=np.mean([point.value for point in points], axis=0),
            size=found.size,
            scatter=found.variance / found.size**2,
            own=covariance / np.outer(found.size, found.size) / len(points),
            degrees_of_freedom=found.degrees_of_freedom,
        )

    def part(self, names: Sequence[str]) -> "Whitening":
        """The same for fewer coordinates."""
        index = [self.names.index(name) for name in names]
        return Whitening(
            names=tuple(names),
            count=self.count,
            centre=self.centre[index],
            size=self.size[index],
            scatter=self.scatter[index],
            own=self.own[np.ix_(index, index)],
            degrees_of_freedom=self.degrees_of_freedom[index],
        )

    def change(self, now: Point) -> Floats:
        """Changes (N,) of a point that has all names [-]."""
        return (now.of(self.names).value - self.centre) / self.size

    def covariance(self, now: Point) -> Floats:
        """Covariance (N, N) of `change` [-]."""
        fit = now.of(self.names).covariance / np.outer(self.size, self.size)
        return fit + self.own + np.diag(self.scatter) * (1.0 + 1.0 / self.count)


def deviations(baseline: Sequence[Point], now: Point) -> Deviations:
    """Deviations of an identification from a baseline. Raises ValueError for an empty baseline."""
    if not baseline:
        raise ValueError("a baseline needs at least one identification")
    names = comparable(baseline, now)
    if not names:
        return Deviations((), ())
    white = Whitening.of(baseline, names)
    change, covariance = white.change(now), white.covariance(now)
    parameters = [
        _parameter(white, change, covariance, [i for i, _ in group])
        for _, group in groupby(enumerate(names), key=lambda pair: parameter_of(pair[1]))
    ]
    elements = [
        _element(white, change, covariance, [i for i, name in enumerate(names) if element_of(name) == element])
        for element in dict.fromkeys(element_of(name) for name in names)
    ]
    return Deviations(tuple(parameters), tuple(elements))


def comparable(baseline: Sequence[Point], now: Point) -> tuple[str, ...]:
    """Coordinates that all of them determine, in the order of the last."""
    common = set(now.names).intersection(*(point.names for point in baseline))
    return tuple(name for name in now.names if name in common)


def parameter_of(coordinate: str) -> str:
    """`disc.D1.unbalance` of `disc.D1.unbalance.real`."""
    said = describe(coordinate)
    return coordinate if said.component is None else said.whole


def element_of(name: str) -> str:
    """`bearing.B1` of `bearing.B1.kxx`."""
    return describe(name).element


def element_distance(white: Whitening, now: Point) -> ElementDistance:
    """Distance of the element that all coordinates of `white` belong to, of a point that has them."""
    return _element(white, white.change(now), white.covariance(now), list(range(len(white.names))))


def chance_of_distance(squared: float, *, size: int, degrees_of_freedom: float) -> float:
    """Probability of a sum of so many squared, independent t values or a larger one.

    Their sum has mean kν/(ν - 2) and the relative variance 2(ν - 1)/((ν - 4)k); so has F with k and m degrees of freedom, for
    the m and the scale used here. Exact for k = 1. degrees_of_freedom: ν, above 4.
    """
    freedom = min(degrees_of_freedom, LARGEST_FREEDOM)
    other = ((size - 2.0) * (freedom - 4.0) + 4.0 * (freedom - 1.0)) / 3.0
    scale = freedom / (freedom - 2.0) * (other - 2.0) / other
    return float(scipy.special.fdtrc(size, other, squared / (scale * size)))


def _parameter(white: Whitening, change: Floats, covariance: Floats, index: list[int]) -> ParameterDeviation:
    name = white.names[index[0]]
    errors = np.sqrt(np.diag(covariance)[index])
    whole = _element(white, change, covariance, index)
    half = float(np.max(errors)) * float(scipy.special.stdtrit(whole.degrees_of_freedom, (1.0 + CONFIDENCE) / 2.0))
    parts = change[index]
    vector = None
    if len(index) == 2:
        moved = float(np.hypot(*parts))
        low, high, sigma = max(0.0, moved - half), moved + half, whole.distance
        vector = complex(*(parts * white.size[index]))
    else:
        (moved,) = parts.tolist()
        low, high, sigma = moved - half, moved + half, math.copysign(whole.distance, moved)
        if is_direct(name):
            moved, low, high = math.expm1(moved), math.expm1(low), math.expm1(high)
    return ParameterDeviation(
        name=parameter_of(name),
        element=element_of(name),
        change=moved,
        lower=low,
        upper=high,
        sigma=sigma,
        degrees_of_freedom=whole.degrees_of_freedom,
        probability=whole.probability,
        vector=vector,
    )


def _element(white: Whitening, change: Floats, covariance: Floats, index: list[int]) -> ElementDistance:
    inverse = np.linalg.inv(covariance[np.ix_(index, index)])
    squared = float(change[index] @ inverse @ change[index])
    part = np.diag(inverse) * white.scatter[index] * (1.0 + 1.0 / white.count)
    freedom = min(1.0 / float(np.mean(part / white.degrees_of_freedom[index])), LARGEST_FREEDOM)
    return ElementDistance(
        element=element_of(white.names[index[0]]),
        names=tuple(white.names[i] for i in index),
        distance=math.sqrt(max(0.0, squared)),
        degrees_of_freedom=freedom,
        probability=chance_of_distance(squared, size=len(index), degrees_of_freedom=freedom),
    )
