"""Deviation of every parameter of an identification from the machine's baseline, and of each element as a whole.

A change is relative: of a direct term, the change of its logarithm; of a cross-coupled term, the change over the direct terms
beside it; of an unbalance, the change of the vector over its magnitude. Its variance is the sum of those of the fit, of the
baseline's mean and of the run-to-run scatter. An element's distance is Mahalanobis's (1936), with these
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
from estimator.machine.parameter_description import describe, is_direct
from estimator.trends.between_run_scatter import between_run_scatter
from estimator.trends.parameter_vector import Point

LARGEST_FREEDOM = 1e6
"""Degrees of freedom beyond which the scatter counts as known."""
CONFIDENCE = 0.95
"""Probability of the intervals [-]."""


@dataclass(frozen=True)
class ParameterDeviation:
    """Deviation of one parameter from its baseline.

    Attributes:
        name: Name of the parameter.
        element: Name of its element.
        change: Change as a part of the baseline value, of the direct terms beside a cross-coupled one, or of an unbalance's
            magnitude, there never negative [-].
        lower: Lower end of its 95 % interval [-].
        upper: Upper end of its 95 % interval [-].
        sigma: Change in standard deviations, with sign; of a complex parameter the distance of both components [-].
        degrees_of_freedom: Degrees of freedom with which the scatter in it is known [-].
        probability: Probability of a change as large, either way, while nothing has changed [-].
        vector: Change of a complex parameter itself [SI]: an unbalance that came on top of the baseline's.
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
    """Distance of all parameters of an element together from the baseline.

    Attributes:
        element: Name of the element.
        names: Names of the real coordinates.
        distance: Mahalanobis's distance [-], about the root of their number while nothing has changed.
        degrees_of_freedom: Degrees of freedom with which the scatter in it is known [-].
        probability: Probability of such a distance or a larger one by chance [-].
    """

    element: str
    names: tuple[str, ...]
    distance: float
    degrees_of_freedom: float
    probability: float


@dataclass(frozen=True)
class Deviations:
    """Deviations of everything that both the baseline and the identification determine, in the identification's order.

    Attributes:
        parameters: Deviation of each parameter.
        elements: Distance of each element.
    """

    parameters: tuple[ParameterDeviation, ...]
    elements: tuple[ElementDistance, ...]


@dataclass(frozen=True)
class Whitening:
    """Measure of changes of N coordinates, from a baseline of n runs.

    Attributes:
        names: Names of the N coordinates.
        count: Number n of runs.
        centre: Mean (N,) of the baseline [unit of the coordinate].
        size: Unit (N,) of the changes, see `between_run_scatter` [unit of the coordinate].
        scatter: Run-to-run variance (N,) of the changes [-].
        own: Covariance (N, N) of the baseline's mean by the fits' errors alone [-].
        degrees_of_freedom: Degrees of freedom (N,) with which each variance is known [-].
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
        """Compute the measure from a baseline's points, for some of their coordinates.

        Args:
            baseline: Points of n runs.
            names: Names of the coordinates.

        Returns:
            The measure.

        Raises:
            ValueError: The baseline is empty, or a name is unknown.
        """
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
        """Return the measure for fewer coordinates.

        Args:
            names: Names of the coordinates to keep.

        Returns:
            The measure of these.
        """
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
        """Compute the changes of a point from the baseline.

        Args:
            now: A point that has all names.

        Returns:
            Changes (N,) [-].
        """
        return (now.of(self.names).value - self.centre) / self.size

    def covariance(self, now: Point) -> Floats:
        """Compute the covariance of `change`.

        Args:
            now: A point that has all names.

        Returns:
            Covariance (N, N) [-].
        """
        fit = now.of(self.names).covariance / np.outer(self.size, self.size)
        return fit + self.own + np.diag(self.scatter) * (1.0 + 1.0 / self.count)


def deviations(baseline: Sequence[Point], now: Point) -> Deviations:
    """Compute the deviations of an identification from a baseline (method and sources in the module's docstring).

    Source: Mahalanobis, Proc. Natl. Inst. Sci. India 2 (1936) 49, with the tails of the module's docstring.

    Args:
        baseline: Points of the baseline.
        now: Point of the identification.

    Returns:
        Deviations of parameters and elements.

    Raises:
        ValueError: The baseline is empty.
    """
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
    """List the coordinates that all of them determine.

    Args:
        baseline: Points of the baseline.
        now: Point of the identification.

    Returns:
        Names in the order of the identification.
    """
    common = set(now.names).intersection(*(point.names for point in baseline))
    return tuple(name for name in now.names if name in common)


def parameter_of(coordinate: str) -> str:
    """Return the parameter of a coordinate: `disc.D1.unbalance` of `disc.D1.unbalance.real`.

    Args:
        coordinate: Name of the coordinate.

    Returns:
        Name of the parameter.
    """
    said = describe(coordinate)
    return coordinate if said.component is None else said.whole


def element_of(name: str) -> str:
    """Return the element of a parameter: `bearing.B1` of `bearing.B1.kxx`.

    Args:
        name: Name of the parameter or coordinate.

    Returns:
        Name of the element.
    """
    return describe(name).element


def element_distance(white: Whitening, now: Point) -> ElementDistance:
    """Compute the distance of one element.

    Source: Mahalanobis, Proc. Natl. Inst. Sci. India 2 (1936) 49.

    Args:
        white: Measure of the element's coordinates and no others.
        now: A point that has these coordinates.

    Returns:
        The element's distance.
    """
    return _element(white, white.change(now), white.covariance(now), list(range(len(white.names))))


def chance_of_distance(squared: float, *, size: int, degrees_of_freedom: float) -> float:
    """Compute the probability of a sum of squared, independent t values, or of a larger one.

    Their sum has mean kν/(ν - 2) and the relative variance 2(ν - 1)/((ν - 4)k); so has F with k and m degrees of freedom, for
    the m and the scale used here. Exact for k = 1.

    Source: own derivation: F with the first two moments matched, as stated above.

    Args:
        squared: Sum of squares [-].
        size: Number k of values.
        degrees_of_freedom: Degrees of freedom ν of each value, above 4 [-].

    Returns:
        Probability [-].
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
