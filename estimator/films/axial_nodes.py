"""Polynomials over half of a pad's length, for pressures that are symmetric about its middle."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial import legendre

from estimator.arrays import Floats


@dataclass(frozen=True)
class AxialNodes:
    """Even polynomials of degree 2 m over -1 ≤ ζ ≤ 1 that vanish at the ends, by their values at m nodes in 0 ≤ ζ < 1.

    Attributes:
        places: The nodes ζ (m,) [-].
        weights: Weights (m,) of the Gauss–Lobatto–Legendre rule for the integral over 0 ≤ ζ ≤ 1 [-].
        stiffness: Integrals (m, m) of the products of the polynomials' derivatives over 0 ≤ ζ ≤ 1 [-].
    """

    places: Floats
    weights: Floats
    stiffness: Floats


@lru_cache(maxsize=32)
def axial_nodes(count: int) -> AxialNodes:
    """Return the nodes, weights and stiffness of a number of nodes.

    Source: C. Canuto et al., Spectral Methods: Fundamentals in Single Domains (2006), section 2.3.

    Args:
        count: Number of nodes m.

    Returns:
        The nodes.
    """
    degree = 2 * count
    series = np.zeros(degree + 1)
    series[-1] = 1.0
    inner = np.sort(legendre.legroots(legendre.legder(series)).real)
    places = np.concatenate([[-1.0], inner, [1.0]])
    last = legendre.legval(places, series)
    weights = 2.0 / (degree * (degree + 1) * last**2)
    apart = places[:, None] - places
    np.fill_diagonal(apart, 1.0)
    slope = last[:, None] / last / apart
    np.fill_diagonal(slope, 0.0)
    slope[0, 0], slope[-1, -1] = -degree * (degree + 1) / 4.0, degree * (degree + 1) / 4.0
    mirrored = np.zeros((degree + 1, count))
    mirrored[count + np.arange(count), np.arange(count)] = 1.0
    mirrored[count - np.arange(count), np.arange(count)] = 1.0
    stiffness = mirrored.T @ slope.T @ (weights[:, None] * slope) @ mirrored
    return AxialNodes(places[count:-1], mirrored.T @ weights / 2.0, stiffness / 2.0)
