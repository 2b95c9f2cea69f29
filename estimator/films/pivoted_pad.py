"""Film of a pad that tilts about a pivot: without inertia and friction its force passes through the pivot.

Tilting the pad changes its film as a motion of the journal across the line through the pivot does. The film is therefore that
of a fixed pad with the journal at (e, δ) from the pad's centre of curvature: e towards the pivot, and δ = tilt × radius across
it, in the sense of rotation. The journal gives e; δ follows from the moment about the pivot, which is that of the force across
(J. W. Lund, ASLE Trans. 7 (1964) 342, doi:10.1080/05698196408972064). So a pad's film is a function of e alone.

Below some e there is no such δ: a pad with its pivot in the middle loses its film where the journal leaves its centre of
curvature (e = 0), one with its pivot behind the middle later.
"""

import math
from dataclasses import dataclass

import numpy as np
import scipy

from estimator.arrays import Floats
from estimator.films.reynolds import PadSolver

LEAST_TILT = 1e-3
"""Smallest δ at which a film is solved for: below, a pad carries next to nothing [c]."""
FARTHEST = -1.0
"""Smallest e at which a film is solved for: what a pad carries there is a hundredth of its usual load [c]."""
WELL_LOADED = 0.3
"""An e at which any pad carries [c]."""
_CLOSEST = 0.015
_STEP, _SMALLEST_STEP, _STEPS = 0.05, 1e-3, 400
_NEWTON_STEPS, _SETTLED = 30, 1e-11


class NoTilt(ArithmeticError):
    """Raised when no tilt is found at which the film's force passes through the pivot."""


@dataclass(frozen=True)
class PivotedFilm:
    """Film of one pad at one place of the journal, over its motion (towards the pivot, across).

    Attributes:
        force: Force on the journal (2,) [μ ω R L (R/c)²].
        stiffness: Stiffness (2, 2) of the fixed pad [μ ω R L (R/c)²/c].
        damping: Damping (2, 2) of the fixed pad [μ R L (R/c)²/c].
        thinnest: Thickness of the film where it is thinnest [c].
    """

    force: Floats
    stiffness: Floats
    damping: Floats
    thinnest: float


class PivotedPadSolver:
    """Solver for the tilt of pads of one geometry."""

    def __init__(self, *, arc: float, pivot: float, slenderness: float, around: int) -> None:
        """Prepare the solver.

        Args:
            arc: Arc of the pad [rad].
            pivot: Place of the pivot as a part of the arc, from the leading edge; 0.5 for the middle [-].
            slenderness: Length over diameter of the journal [-].
            around: Cells of the mesh around the pad.
        """
        self._solver = PadSolver(arc=arc, slenderness=slenderness, around=around)
        self._half = arc / 2.0
        self._behind = (pivot - 0.5) * arc

    def at(self, e: float, across: float) -> PivotedFilm:
        """Solve for the film at one place of the journal and one tilt.

        Args:
            e: Distance of the journal from the pad's centre of curvature towards the pivot [c].
            across: Distance across, in the sense of rotation, tilt included [c].

        Returns:
            The film.
        """
        angle = math.atan2(across, e)
        film = self._solver.solve(math.hypot(e, across), angle + self._behind)
        axes = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
        stiffness, damping = (axes @ one @ axes.T for one in (self._solver.stiffness(film), film.damping))
        return PivotedFilm(axes @ film.force, stiffness, damping, self.thinnest(e, across))

    def thinnest(self, e: float, across: float) -> float:
        """Compute the thickness of the film where it is thinnest.

        Args:
            e: Distance of the journal towards the pivot [c].
            across: Distance across, tilt included [c].

        Returns:
            The thickness [c].
        """
        beyond = max(abs(math.atan2(across, e) + self._behind) - self._half, 0.0)
        return 1.0 - math.hypot(e, across) * math.cos(beyond)

    def across(self, e: float, *, start: float) -> float:
        """Find δ at which the force passes through the pivot, near another.

        Args:
            e: Distance of the journal towards the pivot [c].
            start: A value near it [c].

        Returns:
            The distance δ [c].

        Raises:
            NoTilt: There is none nearby.
        """
        across = start
        for _ in range(_NEWTON_STEPS):
            film = self.at(e, across)
            step = float(film.force[1] / film.stiffness[1, 1])
            step = math.copysign(min(abs(step), 0.1 + 0.1 * across, 0.5 * across), step)
            while self.thinnest(e, across + step) < _CLOSEST:
                step /= 2.0
            across += step
            if abs(step) < _SETTLED * across:
                return across
        raise NoTilt(f"no tilt of a pad found with the journal {e:.3f} clearances towards its pivot")

    def loaded(self) -> float:
        """Find δ with the journal at `WELL_LOADED`.

        Source: balance of moments about the pivot, J. W. Lund, ASLE Trans. 7 (1964) 342, doi:10.1080/05698196408972064.

        Returns:
            The distance δ [c].
        """
        end = self._half - self._behind
        high = (1.0 - _CLOSEST - WELL_LOADED * math.cos(end)) / math.sin(end)
        if math.atan2(high, WELL_LOADED) < end:  # the film closes before the trailing edge
            high = math.sqrt((1.0 - _CLOSEST) ** 2 - WELL_LOADED**2)
        return float(scipy.optimize.brentq(lambda one: self.at(WELL_LOADED, one).force[1], LEAST_TILT, high, xtol=1e-6))

    def unloading(self) -> list[tuple[float, float]]:
        """Follow a pad from where it is well loaded to where it loses its film.

        A step goes along the curve of balanced moments, then back to it across its tangent (H. B. Keller, in P. H. Rabinowitz
        (ed.), Applications of Bifurcation Theory, Academic Press, 1977, 359): the curve turns back at its end.

        Returns:
            Pairs (e, δ), e falling [c].
        """
        place = np.array([WELL_LOADED, self.across(WELL_LOADED, start=self.loaded())])
        found = [(float(place[0]), float(place[1]))]
        step = _STEP
        for _ in range(_STEPS):
            stiffness = self.at(*place).stiffness[1]
            tangent = np.array([-stiffness[1], stiffness[0]]) / np.hypot(*stiffness)
            moved = self._corrected(place + step * tangent, tangent)
            if moved is not None and moved[1] >= LEAST_TILT and moved[0] < place[0] and self._holds(moved):
                place = moved
                found.append((float(place[0]), float(place[1])))
                if place[0] < FARTHEST:
                    break
            elif step < _SMALLEST_STEP:
                break
            else:
                step /= 2.0
        return found

    def _holds(self, place: Floats) -> bool:
        """Return whether the pad's tilt is stable there."""
        return float(self.at(*place).stiffness[1, 1]) > 0.0

    def _corrected(self, place: Floats, tangent: Floats) -> Floats | None:
        """Return the place on the curve straight across the tangent; None where there is none."""
        normal = np.array([-tangent[1], tangent[0]])
        for _ in range(_NEWTON_STEPS):
            if place[1] <= 0.0:
                return None
            film = self.at(*place)
            slope = -float(film.stiffness[1] @ normal)
            step = -float(film.force[1]) / slope
            if abs(step) > _STEP:
                return None
            place = place + step * normal
            if abs(step) < 1e-9:
                return place
        return None
