"""Tilting-pad bearings by brute force: the pads' tilts are found one by one, all motions are reduced as one matrix.

The pads' films come from finite volumes (`reynolds`). Angles, axes and units as there; a tilt is the distance by which it
moves the pad's surface across the line through its pivot, in clearances.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from tests.film_plant.arrays import Complexes, Floats
from tests.film_plant.profile import Pad, Profile
from tests.film_plant.reynolds import Film, FilmSolver

SCANNED = 40
"""Number of tilts tried for the place where a pad's moment changes its sign."""
CLOSEST = 0.03
"""Thinnest film of a pad whose tilt is tried [-]."""


@dataclass(frozen=True)
class RockerPads:
    """Equal pads: number, arc [rad], preload, place of the pivot as a part of the arc [-], direction of the first [rad]."""

    count: int
    arc: float
    preload: float
    pivot: float
    first: float

    @property
    def directions(self) -> Floats:
        """Directions of the pivots (n,) [rad]."""
        return np.asarray(self.first + 2.0 * np.pi / self.count * np.arange(self.count), dtype=float)


TILTING = {"five_pads": RockerPads(5, float(np.radians(60.0)), 0.3, 0.6, -np.pi / 2 + np.pi / 5)}
"""Bearings by name: five offset pads, loaded between two."""


@dataclass(frozen=True)
class TiltedFilm:
    """Film at one position of the journal, its pads balanced.

    Attributes:
        force: Force on the journal (2,) [μωRL(R/c)²].
        stiffness: Stiffness over x, y and the tilts of the loaded pads (2 + n, 2 + n) [μωRL(R/c)²/c].
        damping: Damping over the same [μRL(R/c)²/c].
        tilt: Tilts of the loaded pads (n,) [c].
    """

    force: Floats
    stiffness: Floats
    damping: Floats
    tilt: Floats

    def reduced(self, frequency: float) -> Complexes:
        """Dynamic stiffness (2, 2) at a frequency over the spin speed, the tilts eliminated."""
        whole = self.stiffness + 1j * frequency * self.damping
        return np.asarray(whole[:2, :2] - whole[:2, 2:] @ np.linalg.solve(whole[2:, 2:], whole[2:, :2]))


def tilted(pads: RockerPads, slenderness: float, position: Floats, *, around: int = 240, along: int = 16) -> TiltedFilm:
    """Balance the pads with the journal at a position (2,) [clearances]; a pad without balance carries nothing."""
    force, size = np.zeros(2), 2 + pads.count
    stiffness, damping = np.zeros((size, size)), np.zeros((size, size))
    tilts: list[float] = []
    for direction in pads.directions:
        across = np.array([-np.sin(direction), np.cos(direction)])
        ahead, behind = pads.pivot * pads.arc, (1.0 - pads.pivot) * pads.arc
        pad = Pad(direction - ahead, direction + behind, pads.preload, float(direction))
        solver = FilmSolver(Profile("pad", (pad,)), slenderness, around=around, along=along)
        found = _balance(solver, position, across)
        if found is None:
            continue
        tilt, film = found
        motions = np.zeros((2, size))
        motions[:, :2], motions[:, 2 + len(tilts)] = np.eye(2), across
        force += film.force
        stiffness += motions.T @ film.stiffness @ motions
        damping += motions.T @ film.damping @ motions
        tilts.append(tilt)
    kept = slice(0, 2 + len(tilts))
    return TiltedFilm(force, stiffness[kept, kept], damping[kept, kept], np.array(tilts))


def _balance(solver: FilmSolver, position: Floats, across: Floats) -> tuple[float, Film] | None:
    """The largest tilt without a moment about the pivot, and the film there; None where there is none."""

    def moment(tilt: float) -> float:
        return float(solver.solve(position + tilt * across).force @ across)

    moved = np.linspace(2.5, 0.0, SCANNED, endpoint=False) - float(position @ across)
    tried = [one for one in moved.tolist() if _open(solver, position + one * across)]
    for high, low in zip(tried[:-1], tried[1:], strict=True):
        if moment(low) > 0.0 >= moment(high):
            tilt = float(brentq(moment, low, high, xtol=1e-9))
            return tilt, solver.solve(position + tilt * across)
    return None


def balanced(pads: RockerPads, slenderness: float, place: float, tilt: float) -> tuple[float, Film] | None:
    """Tilt and film of one pad with the journal towards its pivot, along x; None where the pad carries nothing.

    Tilts are tried downwards from a little above the one that is given.
    """
    across = np.array([0.0, 1.0])
    pad = Pad(-pads.pivot * pads.arc, (1.0 - pads.pivot) * pads.arc)
    solver = FilmSolver(Profile("pad", (pad,)), slenderness, around=160, along=12)
    position = np.array([place, 0.0])

    def moment(one: float) -> float:
        return float(solver.solve(position + one * across).force @ across)

    high = 1.3 * tilt
    while not _open(solver, position + high * across):
        high *= 0.97
    low = 0.9 * high
    while moment(low) <= 0.0:
        high, low = low, 0.9 * low
        if low < 0.01:
            return None
    found = float(brentq(moment, low, high, xtol=1e-7))
    return found, solver.solve(position + found * across)


def _open(solver: FilmSolver, position: Floats) -> bool:
    """Return whether the film is nowhere too thin."""
    (pad,) = solver.profile.pads
    angle = np.linspace(pad.start, pad.end, 200)
    gap = 1.0 - pad.preload * np.cos(angle - pad.direction) - position[0] * np.cos(angle) - position[1] * np.sin(angle)
    return bool(gap.min() > CLOSEST)
