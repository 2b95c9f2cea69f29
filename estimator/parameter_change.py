"""What changed from one identification to another, by what both know of their parameters, fit against fit.

Both fits' covariances count; that a machine's parameters differ a little from run to run, too, is not known from two.
"""

from dataclasses import dataclass

import numpy as np
import scipy.special

from estimator.arrays import Floats
from estimator.parameter_description import describe, is_direct


@dataclass(frozen=True)
class ParameterChange:
    """One coordinate. first, second: values in SI. relative: second over first less one, of direct terms only.

    sigma: the change in standard errors of both.
    """

    name: str
    first: float
    second: float
    relative: float | None
    sigma: float


@dataclass(frozen=True)
class ElementChange:
    """All coordinates of an element together. distance: squared Mahalanobis. probability: of one so large by chance."""

    element: str
    distance: float
    degrees_of_freedom: int
    probability: float


@dataclass(frozen=True)
class Values:
    """An identification's values over n coordinates, as in `Identification`: logarithms of direct terms, SI."""

    coordinates: tuple[str, ...]
    point: Floats
    covariance: Floats


def parameter_changes(first: Values, second: Values) -> tuple[ParameterChange, ...]:
    """Changes of the coordinates that both have, in the first one's order."""
    found = []
    for name in first.coordinates:
        if name not in second.coordinates:
            continue
        i, j = first.coordinates.index(name), second.coordinates.index(name)
        before, after = float(first.point[i]), float(second.point[j])
        error = float(np.sqrt(first.covariance[i, i] + second.covariance[j, j]))
        sigma = (after - before) / error if error > 0.0 else (0.0 if after == before else float("inf"))
        if is_direct(name):
            found.append(
                ParameterChange(name, float(np.exp(before)), float(np.exp(after)), float(np.expm1(after - before)), sigma)
            )
        else:
            found.append(ParameterChange(name, before, after, None, sigma))
    return tuple(found)


def element_changes(first: Values, second: Values) -> tuple[ElementChange, ...]:
    """Joint change of each element, such as bearing.B1, over the coordinates that both have and neither knows exactly."""
    elements: dict[str, list[str]] = {}
    for name in first.coordinates:
        if name in second.coordinates:
            elements.setdefault(describe(name).element, []).append(name)
    found = []
    for element, names in elements.items():
        rows, others = ([one.coordinates.index(name) for name in names] for one in (first, second))
        spread = first.covariance[np.ix_(rows, rows)] + second.covariance[np.ix_(others, others)]
        size = np.sqrt(np.diag(spread))
        known = size > 0.0
        if not known.any():
            continue
        change = ((second.point[others] - first.point[rows])[known]) / size[known]
        unit = spread[np.ix_(known, known)] / np.outer(size[known], size[known])
        distance = float(change @ np.linalg.lstsq(unit, change, rcond=1e-10)[0])
        freedom = int(np.linalg.matrix_rank(unit, tol=1e-10))
        found.append(ElementChange(element, distance, freedom, float(scipy.special.chdtrc(freedom, distance))))
    return tuple(found)
