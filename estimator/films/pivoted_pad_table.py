"""Tables of a tilting pad's film over the journal's distance towards the pivot, made once for each geometry.

Near its end (`PivotedPadSolver.unloading`) a pad's load goes with the root of the distance from there, and grows without bound
where the film closes: nodes are even in p with e = e₀ + (1 - e₀)(1 - exp(-p²)), in which both are smooth. Beyond the end a pad
has no film that holds it: it flutters and carries nothing. There its film fades within a tenth of the clearance, twice
differentiable, so that equilibria are found across it.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import scipy

from estimator.arrays import Bools, Complexes, Floats
from estimator.films.pad_table import THINNEST_KNOWN, THINNEST_TABULATED
from estimator.films.pivoted_pad import PivotedFilm, PivotedPadSolver
from estimator.films.reynolds import AROUND

TABLES = 32
"""Number of tables kept; each takes some kB."""
NODES = 120
"""Approximate number of nodes of a table; values between them are within 0.5 % of a solution."""
FADING = 0.1
"""Distance within which a film fades beyond the pad's end [c]."""
ROUNDING = 2e-3
"""Distance over which the root of the distance from a pad's end is rounded off [c]."""
_LAST = 2.1
_STIFFNESS, _DAMPING = slice(1, 5), slice(5, 9)


@dataclass(frozen=True)
class BalancedPads:
    """Films of pads in balance on their pivots, at distances (...).

    Matrices are over the journal's motion towards the pivot and across, tilt included, of a pad that is held. `weight` goes
    with forces, stiffness and damping; it is in `push` but not in the matrices.

    Attributes:
        push: Force (...) with which a pad pushes the journal away [μ ω R L (R/c)²].
        push_slope: Its derivative (...) by e [μ ω R L (R/c)²/c].
        stiffness: Stiffness (..., 2, 2) [μ ω R L (R/c)²/c].
        damping: Damping (..., 2, 2) [μ R L (R/c)²/c].
        stiffness_slope: Derivatives (..., 2, 2) of the stiffness by e [μ ω R L (R/c)²/c²].
        damping_slope: Derivatives (..., 2, 2) of the damping by e [μ R L (R/c)²/c²].
        weight: Part of the film that is there (...): 0 where a pad is unloaded [-].
        weight_slope: Its derivative (...) by e [1/c].
    """

    push: Floats
    push_slope: Floats
    stiffness: Floats
    damping: Floats
    stiffness_slope: Floats
    damping_slope: Floats
    weight: Floats
    weight_slope: Floats

    def reduced(self, eigenvalue: complex) -> tuple[Complexes, Complexes]:
        """Reduce the pads to what the journal meets in a motion e^{λt} towards the pivot; across, a free pad does nothing.

        Source: J. W. Lund, ASLE Trans. 7 (1964) 342, without the pads' inertia.

        Args:
            eigenvalue: λ over the spin speed; the imaginary unit for an unbalance [-].

        Returns:
            Dynamic stiffness (...) [μ ω R L (R/c)²/c] and its derivative by e [μ ω R L (R/c)²/c²].
        """
        z, by = self.stiffness + eigenvalue * self.damping, self.stiffness_slope + eigenvalue * self.damping_slope
        along, out, back, own = z[..., 0, 0], z[..., 0, 1], z[..., 1, 0], z[..., 1, 1]
        held = along - out * back / own
        slope = by[..., 0, 0] - (by[..., 0, 1] * back + out * by[..., 1, 0]) / own + out * back * by[..., 1, 1] / own**2
        return np.asarray(self.weight * held), np.asarray(self.weight_slope * held + self.weight * slope)


class PivotedPadTable:
    """Film of a tilting pad of one geometry over the journal's distance e towards its pivot."""

    def __init__(self, *, arc: float, pivot: float, slenderness: float, around: int = AROUND, nodes: int = NODES) -> None:
        """Solve for the pad's balance at every node.

        Args:
            arc: Arc of the pad [rad].
            pivot: Place of the pivot as a part of the arc, from the leading edge [-].
            slenderness: Length over diameter of the journal [-].
            around: Cells of the solver's mesh around the pad.
            nodes: Number of nodes.
        """
        solver = PivotedPadSolver(arc=arc, pivot=pivot, slenderness=slenderness, around=around)
        curve = np.array(solver.unloading()[::-1])
        self._end = float(curve[0, 0])
        places = _over_root(curve[:, 0] - self._end, 1.0 - self._end)
        p, across, rows = [0.0], [float(curve[0, 1])], [solver.at(*curve[0])]
        while rows[-1].thinnest > THINNEST_TABULATED and p[-1] < _LAST:
            p.append(p[-1] + _LAST / nodes)
            e = self._end - (1.0 - self._end) * math.expm1(-(p[-1] ** 2))
            start = float(np.interp(p[-1], places, curve[:, 1])) if e < curve[-1, 0] else _extrapolated(across)
            across.append(solver.across(e, start=start))
            rows.append(solver.at(e, across[-1]))
        self._last = self._end - (1.0 - self._end) * math.expm1(-(p[-1] ** 2))
        self._thinnest_last = rows[-1].thinnest
        self._spline = scipy.interpolate.CubicSpline(np.array(p), np.array([_quantities(one) for one in rows]))

    def thinnest(self, e: Floats) -> Floats:
        """Compute the thickness of the film where it is thinnest.

        Args:
            e: Distances (...) of the journal from the pad's centre of curvature towards its pivot [c].

        Returns:
            Thicknesses (...), negative where the journal would be in the pad [c].
        """
        known = self._spline(self._places(np.minimum(e, self._last))[0])[..., -1]
        return np.asarray(np.where(e > self._last, self._thinnest_last * (1.0 - e) / (1.0 - self._last), known))

    def covers(self, e: Floats) -> Bools:
        """Return where the film is thick enough for the table.

        Args:
            e: Distances (...) of the journal towards the pivot [c].

        Returns:
            Whether it is (...).
        """
        return np.asarray((e <= self._last) & (self.thinnest(e) >= THINNEST_KNOWN - 1e-12))

    def at(self, e: Floats) -> BalancedPads:
        """Interpolate the film.

        Args:
            e: Distances (...) of the journal towards the pivot, where the table holds [c].

        Returns:
            The film.
        """
        p, by_e = self._places(e)
        value, slope = self._spline(p), self._spline(p, 1) * by_e[..., None]
        t = np.clip((e - self._end) / FADING + 1.0, 0.0, 1.0)
        weight = t**3 * (10.0 + t * (6.0 * t - 15.0))
        weight_slope = 30.0 * t**2 * (1.0 - t) ** 2 / FADING
        return BalancedPads(
            push=weight * value[..., 0],
            push_slope=weight * slope[..., 0] + weight_slope * value[..., 0],
            stiffness=_matrices(value, _STIFFNESS),
            damping=_matrices(value, _DAMPING),
            stiffness_slope=_matrices(slope, _STIFFNESS),
            damping_slope=_matrices(slope, _DAMPING),
            weight=weight,
            weight_slope=weight_slope,
        )

    def _places(self, e: Floats) -> tuple[Floats, Floats]:
        """Return the coordinate p (...) and its derivative by e."""
        x = np.asarray(e, dtype=float) - self._end
        root = np.hypot(x, ROUNDING)
        rounded = np.where(x > 0.0, (x + root) / 2.0, ROUNDING**2 / (2.0 * (root + np.abs(x))))
        p = _over_root(rounded, 1.0 - self._end)
        return p, rounded / root / (2.0 * p * (1.0 - self._end - rounded))


def _over_root(x: Floats, whole: float) -> Floats:
    """Return p (...) at distances x (...) from the pad's end [c]. whole: distance from there to where the film closes [c]."""
    return np.asarray(np.sqrt(-np.log1p(-x / whole)))


def _extrapolated(found: list[float]) -> float:
    """Predict the next of values at even steps, with the parabola through the last three."""
    return 3.0 * found[-1] - 3.0 * found[-2] + found[-3]


def _quantities(film: PivotedFilm) -> Floats:
    return np.array([-film.force[0], *film.stiffness.ravel(), *film.damping.ravel(), film.thinnest])


def _matrices(values: Floats, part: slice) -> Floats:
    return values[..., part].reshape(*values.shape[:-1], 2, 2)


@lru_cache(maxsize=TABLES)
def pivoted_pad_table(*, arc: float, pivot: float, slenderness: float) -> PivotedPadTable:
    """Return the table of a tilting pad, which is made when it is first asked for.

    Args:
        arc: Arc of the pad [rad].
        pivot: Place of the pivot as a part of the arc, from the leading edge [-].
        slenderness: Length over diameter of the journal [-].

    Returns:
        The table.
    """
    return PivotedPadTable(arc=arc, pivot=pivot, slenderness=slenderness)
