"""Changes of parameters from one identification to another, fit against fit.

Both fits' covariances count; that a machine's parameters differ a little from run to run, too, is not known from two. An
element's distance is Mahalanobis's (Proc. Natl. Inst. Sci. India 2 (1936) 49).
"""

from dataclasses import dataclass

import numpy as np
import scipy.special

from estimator.arrays import Floats
from estimator.machine.parameter_description import describe, is_direct


@dataclass(frozen=True)
class ParameterChange:
    """Change of one coordinate.

    Attributes:
        name: Name of the coordinate.
        first: First value [SI].
        second: Second value [SI].
        relative: Second over first less one, of direct terms only [-].
        sigma: Change in standard errors of both [-].
    """

    name: str
    first: float
    second: float
    relative: float | None
    sigma: float


@dataclass(frozen=True)
class ElementChange:
    """Change of all coordinates of an element together.

    Attributes:
        element: Name of the element.
        distance: Squared Mahalanobis distance [-].
        degrees_of_freedom: Its degrees of freedom.
        probability: Probability of one so large by chance [-].
    """

    element: str
    distance: float
    degrees_of_freedom: int
    probability: float


@dataclass(frozen=True)
class Values:
    """Values of an identification over n coordinates.

    Attributes:
        coordinates: Names of the coordinates.
        point: Values (n,) [SI, logarithms of direct terms].
        covariance: Covariance (n, n) [SI²].
    """

    coordinates: tuple[str, ...]
    point: Floats
    covariance: Floats


def parameter_changes(first: Values, second: Values) -> tuple[ParameterChange, ...]:
    """Compute the changes of the coordinates that both identifications have.

    Args:
        first: Values of the first identification.
        second: Values of the second one.

    Returns:
        Changes in the first one's order.
    """
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
    """Compute the joint change of each element, such as bearing.B1.

    It is taken over the coordinates that both identifications have and that are not known exactly.

    Source: Mahalanobis, Proc. Natl. Inst. Sci. India 2 (1936) 49.

    Args:
        first: Values of the first identification.
        second: Values of the second one.

    Returns:
        Changes in the first one's order.
    """
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
