"""Cubic splines nearest to many values, with LAPACK alone: a first fit would load scipy.interpolate for it, 0.1 s."""

import numpy as np
import scipy
from numpy.typing import NDArray

from estimator.arrays import Floats

DEGREE = 3
WITHIN_PIECE = np.linspace(0.0, 1.0, DEGREE + 1)
"""Places in a piece, as parts of its length, at which four values are its cubic."""


def least_squares_spline(place: Floats, values: Floats, *, inner: Floats) -> tuple[Floats, Floats]:
    """Fit the cubic spline with given knots that is nearest to values.

    Source: de Boor, A Practical Guide to Splines, Springer 1978, chapters X and XIV.

    Args:
        place: Ascending places (S,) [any unit].
        values: Values (S,) there [any unit].
        inner: Ascending knots (n - 1,) between the first and the last place, a place between any two [unit of the places].

    Returns:
        Beginnings (n,) of the pieces, and their coefficients (4, n) of powers 3 to 0 of the distance from there
        [units of values and places].
    """
    ends = np.concatenate([place[:1], inner, place[-1:]])
    knots = np.concatenate([np.repeat(ends[0], DEGREE), ends, np.repeat(ends[-1], DEGREE)])
    piece = np.clip(np.searchsorted(ends, place, side="right") - 1, 0, ends.size - 2)
    basis = _basis(knots, place, piece)
    columns = piece[:, None] + np.arange(DEGREE + 1)
    size = ends.size + DEGREE - 1
    # Only DEGREE + 1 of them are not zero anywhere, so the normal equations are a band.
    band = np.zeros((DEGREE + 1, size))
    for apart in range(DEGREE + 1):
        product = basis[:, apart:] * basis[:, : DEGREE + 1 - apart]
        np.add.at(band[DEGREE - apart], columns[:, apart:], product)
    right = np.bincount(columns.ravel(), (basis * values[:, None]).ravel(), minlength=size)
    weights = scipy.linalg.solveh_banded(band, right)
    pieces = np.repeat(np.arange(ends.size - 1), DEGREE + 1)
    width = np.diff(ends)
    at = (ends[:-1, None] + width[:, None] * WITHIN_PIECE).ravel()
    found = np.sum(_basis(knots, at, pieces) * weights[pieces[:, None] + np.arange(DEGREE + 1)], axis=1)
    scaled = np.linalg.solve(np.vander(WITHIN_PIECE), found.reshape(-1, DEGREE + 1).T)
    return ends[:-1], scaled / width ** np.arange(DEGREE, -1, -1)[:, None]


def _basis(knots: Floats, place: Floats, piece: NDArray[np.intp]) -> Floats:
    """Return the B-splines (S, 4) that are not zero in the pieces, by the recurrence of Cox and de Boor."""
    found = np.ones((place.size, 1))
    first = piece + DEGREE
    for degree in range(1, DEGREE + 1):
        higher = np.zeros((place.size, degree + 1))
        for which in range(degree):
            right, left = knots[first + which + 1], knots[first + which + 1 - degree]
            share = found[:, which] / (right - left)
            higher[:, which] += (right - place) * share
            higher[:, which + 1] += (place - left) * share
        found = higher
    return found
