"""Tables of a pad's film over the journal's position, made once for each geometry.

Coordinates are the direction φ of the journal from the pad's centre of curvature, from the middle of the pad, and
s = -ln(1 - ε/q(φ)), whose equal steps are equal ratios of the thinnest film. The reach q is 1 where the thinnest film is on
the pad, and grows beyond its edges, where the journal may go farther. The force over ε is tabulated: at ε = 0 a film that
ruptures has a stiffness that depends on the direction in which the journal leaves, and polar coordinates keep that exactly. A
spline of its values is twice differentiable everywhere else, and stiffness is its derivative: never tabulated itself, so that
it fits the force. A pad's preload only shifts the position, so that pads that differ in nothing else share a table.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import scipy

from estimator.arrays import Bools, Floats
from estimator.films.pad import FULL_ARC
from estimator.films.reynolds import AROUND, PadSolver
from estimator.films.tensor_spline import TensorSpline

TABLES = 32
"""Number of tables kept; each takes below 2 MB."""
THINNEST_TABULATED = 0.028
"""Smallest 1 - ε/q of a table [-]."""
THINNEST_FILM = 0.05
"""Thinnest film of a document's bearing at a speed at which it is watched [c]: below it, roughness and deflection rule."""
THINNEST_KNOWN = 0.03
"""Thinnest film for which tables are used [c]: a fit may find films thinner than the document's."""
MOST_CONTINUOUS = 2.0
"""Largest slenderness for which a film that forms again by itself is ruptured somewhere [-]."""
RADIAL_NODES, ANGULAR_NODES = 28, 160
"""Numbers of nodes of a table: between them force, stiffness and damping are within 0.5 % of a solution's."""
FARTHER, FARTHER_WITHIN = 0.3, 1.2
"""Most by which the reach grows beyond a pad's edges [c], and the angle within which it does [rad]."""


@dataclass(frozen=True)
class PolarFilm:
    """Film of one pad at positions (...), in the frame of the journal's direction (radial, tangential).

    Units as of `PadFilm`. Derivatives by ε and by φ are those of the components in the frame that turns with φ.

    Attributes:
        force_ratio: Force over ε (..., 2) [-].
        first: Its derivatives (..., 2, 2) by ε and by φ; last axis: component [-].
        second: Its second derivatives (..., 3, 2) by εε, εφ and φφ; last axis: component [-].
        damping: Radial damping (...) [-].
        damping_first: Its derivatives (..., 2) by ε and by φ [-].
    """

    force_ratio: Floats
    first: Floats
    second: Floats
    damping: Floats
    damping_first: Floats


class PadTable:
    """Film of one pad's geometry over the journal's position."""

    def __init__(
        self,
        *,
        arc: float,
        slenderness: float,
        continuous: bool = False,
        around: int = AROUND,
        radial_nodes: int = RADIAL_NODES,
        angular_nodes: int = ANGULAR_NODES,
    ) -> None:
        """Solve for the film at every node.

        Args:
            arc: Arc of the pad [rad].
            slenderness: Length over diameter of the journal [-].
            continuous: Whether the film of a pad of 360° forms again by itself: the pad's edges are then put where it opens
                fastest, where there is none up to a slenderness of `MOST_CONTINUOUS`.
            around: Cells of the solver's mesh around the pad.
            radial_nodes: Number of eccentricities.
            angular_nodes: Number of directions; a pad of 360° needs one.
        """
        self._half = arc / 2.0
        self._within = min(FARTHER_WITHIN, math.pi - self._half) or 1.0
        self._farther = min(FARTHER, 0.4 / math.cos(min(self._within, 1.0)) - 0.4) if arc < FULL_ARC else 0.0
        solver = PadSolver(arc=arc, slenderness=slenderness, around=around)
        share = np.linspace(0.0, 1.0, radial_nodes)
        s = -math.log(THINNEST_TABULATED) * share * (0.45 + 0.55 * share)
        turn = _directions(self._half, angular_nodes) if arc < FULL_ARC else np.array([math.pi / 2.0 if continuous else 0.0])
        reach = self._reach(turn)[0]
        values = np.empty((s.size, turn.size, 3))
        for i, j in np.ndindex(values.shape[:2]):
            film = solver.solve(float(-np.expm1(-s[i]) * reach[j]), float(turn[j]))
            values[i, j] = *film.force_over_eccentricity, film.radial_damping
        self._spline = TensorSpline(s, turn if arc < FULL_ARC else None, values)

    def thinnest(self, eccentricity: Floats, direction: Floats) -> Floats:
        """Compute the thickness of the film where it is thinnest.

        Args:
            eccentricity: Eccentricities (...) from the pad's centre of curvature [c].
            direction: Directions (...), from the middle of the pad, within ±π [rad].

        Returns:
            Thicknesses (...) [c].
        """
        return np.asarray(1.0 - eccentricity * np.cos(np.maximum(np.abs(direction) - self._half, 0.0)))

    def covers(self, eccentricity: Floats, direction: Floats) -> Bools:
        """Return where the table holds: where the film is thick enough, and the journal not too far behind the pad.

        Args:
            eccentricity: Eccentricities (...) from the pad's centre of curvature [c].
            direction: Directions (...), from the middle of the pad, within ±π [rad].

        Returns:
            Whether it does (...).
        """
        near = eccentricity <= (1.0 - THINNEST_TABULATED) * self._reach(direction)[0]
        return near & (self.thinnest(eccentricity, direction) >= THINNEST_KNOWN - 1e-12)

    def at(self, eccentricity: Floats, direction: Floats) -> PolarFilm:
        """Interpolate the film.

        Args:
            eccentricity: Eccentricities (...) from the pad's centre of curvature, where the table holds [c].
            direction: Directions (...), from the middle of the pad, within ±π [rad].

        Returns:
            The film.
        """
        q, q1, q2 = self._reach(direction)
        gap = q - eccentricity
        s = np.log(q / gap)
        # Derivatives of s by ε and φ: first (2), second (εε, εφ, φφ).
        by_e, by_f = 1.0 / gap, q1 / q - q1 / gap
        by_ee, by_ef = 1.0 / gap**2, -q1 / gap**2
        by_ff = q2 / q - (q1 / q) ** 2 - q2 / gap + (q1 / gap) ** 2
        found = self._spline.at(s, direction)
        by_s, by_b = found.first[..., 0, :], found.first[..., 1, :]
        by_ss, by_sb, by_bb = (found.second[..., one, :] for one in range(3))
        e, f, ee, ef, ff = (one[..., None] for one in (by_e, by_f, by_ee, by_ef, by_ff))
        first, second = np.empty_like(found.first), np.empty_like(found.second)
        first[..., 0, :], first[..., 1, :] = by_s * e, by_s * f + by_b
        second[..., 0, :] = by_ss * e**2 + by_s * ee
        second[..., 1, :] = by_ss * e * f + by_sb * e + by_s * ef
        second[..., 2, :] = by_ss * f**2 + 2.0 * by_sb * f + by_s * ff + by_bb
        return PolarFilm(found.value[..., :2], first[..., :2], second[..., :2], found.value[..., 2], first[..., 2])

    def _reach(self, direction: Floats) -> tuple[Floats, Floats, Floats]:
        """Return the reach q (...) and its first two derivatives by the direction."""
        if self._farther == 0.0:  # all around it is the clearance
            return np.ones_like(direction), np.zeros_like(direction), np.zeros_like(direction)
        t = np.clip((np.abs(direction) - self._half) / self._within, 0.0, 1.0)
        step = t**3 * (10.0 + t * (6.0 * t - 15.0))
        slope = 30.0 * t**2 * (1.0 - t) ** 2 / self._within * np.sign(direction)
        bend = 60.0 * t * (1.0 - t) * (1.0 - 2.0 * t) / self._within**2
        return 1.0 + self._farther * step, self._farther * slope, self._farther * bend


def _directions(half: float, count: int) -> Floats:
    """Return directions of one turn (count,), twice as dense where the thinnest film is on the pad."""
    even = np.linspace(-math.pi, math.pi, 2001)
    density = 1.0 + scipy.special.expit((half + 0.35 - np.abs(even)) / 0.15)
    share = np.concatenate([[0.0], np.cumsum(density[1:] + density[:-1])])
    return np.asarray(np.interp(np.arange(count) / count * share[-1], share, even), dtype=float)


@lru_cache(maxsize=TABLES)
def pad_table(*, arc: float, slenderness: float, continuous: bool = False) -> PadTable:
    """Return the table of a pad, which is made when it is first asked for.

    Args:
        arc: Arc of the pad [rad].
        slenderness: Length over diameter of the journal [-].
        continuous: Whether the film of a pad of 360° forms again by itself.

    Returns:
        The table.
    """
    return PadTable(arc=arc, slenderness=slenderness, continuous=continuous)
