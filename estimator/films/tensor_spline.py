"""Piecewise polynomials over two coordinates, the second periodic or absent, with their derivatives.

Cubic splines as in C. de Boor, A Practical Guide to Splines, Springer, 1978.
"""

from dataclasses import dataclass

import numpy as np
import scipy

from estimator.arrays import Floats


@dataclass(frozen=True)
class SplineValue:
    """Q quantities at points (...) and their derivatives by the two coordinates a and b.

    Attributes:
        value: Values (..., Q) [any unit].
        first: First derivatives (..., 2, Q), by a and by b [that unit].
        second: Second derivatives (..., 3, Q), by aa, ab and bb [that unit].
    """

    value: Floats
    first: Floats
    second: Floats


class TensorSpline:
    """Cubic tensor spline of Q quantities over a and a periodic angle b, or over a alone."""

    def __init__(self, a: Floats, b: Floats | None, values: Floats) -> None:
        """Interpolate the values.

        Args:
            a: Nodes (A,), ascending [any unit].
            b: Nodes (B,) of one turn, ascending, without the last, which is the first [rad]; None where nothing depends on b.
            values: Values at the nodes (A, B, Q), with B = 1 where nothing depends on b [any unit].
        """
        # Axes of the coefficients: power of a, cell of a, power of b, cell of b, quantity.
        self._a, along_a = _pieces(a, values, periodic=False)
        if b is None:
            self._b, pieces = np.array([-np.inf, np.inf]), along_a[:, :, None]
        else:
            closed = np.concatenate([along_a, along_a[:, :, :1]], axis=2)
            self._b, along_b = _pieces(np.append(b, b[0] + 2.0 * np.pi), np.moveaxis(closed, 2, 0), periodic=True)
            pieces = np.moveaxis(along_b, (0, 1), (2, 3))
        self._pieces = np.ascontiguousarray(np.moveaxis(pieces, (1, 3), (0, 1)))

    def at(self, a: Floats, b: Floats) -> SplineValue:
        """Compute values and derivatives; beyond the ends of a the last polynomials go on.

        Args:
            a: First coordinates (...) [that of the nodes].
            b: Second coordinates (...), in the turn of the nodes [rad].

        Returns:
            Values and derivatives (...) of those points.
        """
        cell_a, powers_a = _powers(self._a, a)
        if self._pieces.shape[3] == 1:
            cell_b, powers_b = np.zeros_like(cell_a), np.zeros((*a.shape, 3, 1))
            powers_b[..., 0, 0] = 1.0
        else:
            cell_b, powers_b = _powers(self._b, b)
        pieces = self._pieces[cell_a, cell_b]
        over_a = (powers_a @ pieces.reshape(*a.shape, pieces.shape[-3], pieces.shape[-2] * pieces.shape[-1])).reshape(
            *a.shape, 3, *pieces.shape[-2:]
        )
        found = np.einsum("...djq,...ej->...deq", over_a, powers_b)
        return SplineValue(found[..., 0, 0, :], found[..., [1, 0], [0, 1], :], found[..., [2, 1, 0], [0, 1, 2], :])


def _pieces(nodes: Floats, values: Floats, *, periodic: bool) -> tuple[Floats, Floats]:
    """Return break points (n + 1,) and polynomials (4, n, …), highest power first, through values (nodes, …)."""
    pieces = scipy.interpolate.CubicSpline(nodes, values, bc_type="periodic" if periodic else "not-a-knot")
    return pieces.x, pieces.c


def _powers(breaks: Floats, place: Floats) -> tuple[np.ndarray[tuple[int, ...], np.dtype[np.intp]], Floats]:
    """Return each place's cell, and the powers of the distance into it with their first two derivatives (..., 3, 4)."""
    cell = np.clip(np.searchsorted(breaks, place, side="right") - 1, 0, breaks.size - 2)
    t = place - breaks[cell]
    powers = np.zeros((*t.shape, 3, 4))
    powers[..., 0, 3] = powers[..., 1, 2] = 1.0
    powers[..., 0, 2], powers[..., 1, 1], powers[..., 2, 0] = t, 2.0 * t, 6.0 * t
    powers[..., 0, 1], powers[..., 2, 1] = t * t, 2.0
    powers[..., 0, 0], powers[..., 1, 0] = t * powers[..., 0, 1], 3.0 * powers[..., 0, 1]
    return cell, powers
