"""Tables of films over the journal's position, one for each bore and slenderness, and their interpolation.

Around the centre of curvature of a pad its film turns with the direction of the journal within any distance, so that a table
over the bore's own middle would smooth it. Bores of several pads are therefore tabulated pad by pad, over the journal's
eccentricity and direction around the centre of the pad: there the film is smooth in both. A bore's film is the sum of its
pads'. At random places forces differ by up to 0.3 % from the estimator's, stiffness by 0.8 % and damping by 1.6 %; nine in ten
by up to 0.2 %, 0.3 % and 0.4 %.

Forces grow without bound as the film closes: tables hold them times powers of 1 - s², where s is the eccentricity.

`python -m tests.film_plant.film_table` computes anew the tables that are kept in tests/data/film-tables.npz, in some minutes.
"""

from dataclasses import dataclass
from functools import cache
from typing import Protocol

import numpy as np
from scipy.interpolate import CubicHermiteSpline, CubicSpline, RectBivariateSpline

from tests.film_plant.arrays import Floats
from tests.film_plant.profile import PROFILES, Pad, Profile, reach
from tests.film_plant.reynolds import FilmSolver
from tests.paths import DATA

KEPT = DATA / "film-tables.npz"
"""Tables that are kept."""
KEPT_SLENDERNESS = (0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0)
"""Slenderness L/D of the tables that are kept, for plain bores [-]; others at 0.5 and 0.8."""
ROUND_WAYS = 1.0 - np.exp(-np.linspace(0.0, 3.5, 40))
"""Eccentricities of a table of a round bore [-]: up to 0.97."""
WAYS = 1.0 - np.exp(-np.linspace(0.0, 4.0, 25))
"""Eccentricities around the centre of a pad of its table [-]: up to 0.98."""
DIRECTIONS = 90
"""Directions of a pad's table, all around."""
PAD_CELLS = (240, 20)
"""Cells around a pad and along half of its length for its table."""
FORCE_POWER, STIFFNESS_POWER, DAMPING_POWER = 2, 3, 2
"""Powers of 1 - s² by which tables are multiplied."""
POWERS = np.repeat([FORCE_POWER, STIFFNESS_POWER, DAMPING_POWER], [2, 4, 4])
"""The same for each column of a table (10,)."""
SMALLEST_WAY = 1e-4
"""Way that stands for the middle, where which cells carry pressure depends on the direction of the first movement [-]."""
BEYOND = 4
"""Directions that a table is carried on at either end, since it is periodic."""


class OutsideTable(ValueError):
    """Raised when a journal is closer to the wall than a table goes."""


@dataclass(frozen=True)
class FilmValues:
    """Force on the journal (2,), stiffness and damping (2, 2) at one position, in the units of `reynolds.Film`.

    `slow` is the stiffness (2, 2) against slow motions where that is another, as of pads that tilt.
    """

    force: Floats
    stiffness: Floats
    damping: Floats
    slow: Floats | None = None


class FilmTable(Protocol):
    """Film of one bore over the journal's position."""

    def way(self, position: Floats) -> float:
        """Way of the journal at a position (2,) [clearances] to the wall it moves towards, from 0 to 1 [-]."""
        ...

    def at(self, position: Floats) -> FilmValues:
        """Film at a position (2,) [clearances]."""
        ...


class RoundTable:
    """Film of a round bore: a function of the eccentricity alone, along and across the journal's displacement.

    Stiffness is the derivative of the interpolated force.

    Args:
        rows: Force (2), stiffness (4), damping (4) at `ROUND_WAYS` with the journal moved along +x (n, 10).
    """

    def __init__(self, rows: Floats) -> None:
        fade = 1.0 - ROUND_WAYS**2
        slope = -rows[:, [2, 4]]
        scaled = fade[:, None] ** FORCE_POWER * rows[:, :2]
        inner = -2.0 * FORCE_POWER * ROUND_WAYS * fade ** (FORCE_POWER - 1)
        force = CubicHermiteSpline(ROUND_WAYS, scaled, fade[:, None] ** FORCE_POWER * slope + inner[:, None] * rows[:, :2])
        damping = CubicSpline(ROUND_WAYS, fade[:, None] ** DAMPING_POWER * rows[:, 6:])
        quadratic = force.derivative().c
        # One look-up of all: the slope as cubics without their first term.
        cubic = np.concatenate([np.zeros_like(quadratic[:1]), quadratic])
        # One cubic of all ten columns between each two ways (n - 1, 4, 10), highest power first.
        self._cubics = np.concatenate([force.c, cubic, damping.c], axis=2).swapaxes(0, 1)

    def way(self, position: Floats) -> float:
        """Way to the wall: the eccentricity."""
        return float(np.hypot(*position))

    def at(self, position: Floats) -> FilmValues:
        """Film at a position (2,) [clearances]."""
        way = self.way(position)
        if way > ROUND_WAYS[-1]:
            raise OutsideTable(f"eccentricity {way:.3f} is above {ROUND_WAYS[-1]:.3f}")
        fade = 1.0 - way**2
        place = min(int(np.searchsorted(ROUND_WAYS, way, side="right")), len(self._cubics)) - 1
        third, second, first, constant = self._cubics[place]
        beyond = way - ROUND_WAYS[place]
        columns = ((third * beyond + second) * beyond + first) * beyond + constant
        force, slope, damping = columns[:2], columns[2:4], columns[4:]
        force = force / fade**FORCE_POWER
        slope = slope / fade**FORCE_POWER + 2 * FORCE_POWER * way / fade * force
        # The limit in the middle: force there is that of the slope.
        across = force / way if way > 1e-6 else slope
        stiffness = -np.array([[slope[0], -across[1]], [slope[1], across[0]]])
        damping = (damping / fade**DAMPING_POWER).reshape(2, 2)
        cosine, sine = position / way if way > 1e-6 else (1.0, 0.0)
        turn = np.array([[cosine, -sine], [sine, cosine]])
        return FilmValues(turn @ force, turn @ stiffness @ turn.T, turn @ damping @ turn.T)


class PadsTable:
    """Film of a bore of equal pads: the sum of theirs.

    Args:
        profile: The bore.
        grid: Force (2), stiffness (4), damping (4) of a pad in the direction +x, at `WAYS` and `DIRECTIONS` around its centre
            (ways, directions, 10).
    """

    def __init__(self, profile: Profile, grid: Floats) -> None:
        self.profile = profile
        around = np.arange(-BEYOND, DIRECTIONS + BEYOND)
        angle = directions()[0] + 2 * np.pi / DIRECTIONS * around
        scaled = (1.0 - WAYS**2)[:, None, None] ** POWERS * grid[:, around % DIRECTIONS]
        self._splines = [RectBivariateSpline(WAYS, angle, scaled[..., k]) for k in range(len(POWERS))]
        direction = np.array([pad.direction for pad in profile.pads])
        cosine, sine = np.cos(direction), np.sin(direction)
        self._turns = np.stack([np.stack([cosine, -sine], axis=-1), np.stack([sine, cosine], axis=-1)], axis=-2)
        self._preloads = np.array([pad.preload for pad in profile.pads])

    def way(self, position: Floats) -> float:
        """Way to the wall that the journal moves towards, from 0 to 1 [-]."""
        direction = np.array([np.arctan2(position[1], position[0])])
        return float(np.hypot(*position) / reach(self.profile, direction)[0])

    def at(self, position: Floats) -> FilmValues:
        """Film at a position (2,) [clearances]."""
        turns = self._turns
        own = position @ turns + np.stack([self._preloads, np.zeros(len(turns))], axis=-1)
        way, direction = np.hypot(*own.T), np.arctan2(own[:, 1], own[:, 0])
        if way.max() > WAYS[-1]:
            raise OutsideTable(f"the journal's eccentricity in a pad, {way.max():.3f}, is above {WAYS[-1]:.3f}")
        scaled = np.stack([spline(way, direction, grid=False) for spline in self._splines], axis=-1)
        found = scaled / (1.0 - way[:, None] ** 2) ** POWERS
        matrices = turns[:, None] @ found[:, 2:].reshape(-1, 2, 2, 2) @ turns[:, None].swapaxes(-1, -2)
        return FilmValues(np.einsum("nij,nj->i", turns, found[:, :2]), *matrices.sum(axis=0))


def directions() -> Floats:
    """Directions of a table (DIRECTIONS,) [rad], from -π on."""
    return np.linspace(-np.pi, np.pi, DIRECTIONS, endpoint=False)


def computed(profile: Profile, slenderness: float) -> Floats:
    """Solve for a table: rows (n, 10) of a round bore, else a grid (ways, directions, 10) of one of its equal pads."""
    if profile.round:
        solver = FilmSolver(profile, slenderness, around=720, along=20)
        return _along(solver, ROUND_WAYS, np.array([1.0, 0.0]))
    around, along = PAD_CELLS
    half = arc(profile) / 2
    solver = FilmSolver(Profile("pad", (Pad(-half, half),)), slenderness, around=around, along=along)
    return np.stack([_along(solver, WAYS, np.array([np.cos(a), np.sin(a)])) for a in directions()], axis=1)


def arc(profile: Profile) -> float:
    """Arc [rad] of each of a bore's pads, which are equal, each with its preload towards its own middle."""
    first = profile.pads[0]
    for pad in profile.pads:
        if not np.allclose([pad.end - pad.direction, pad.direction - pad.start], (first.end - first.start) / 2):
            raise ValueError(f"the pads of {profile.name} differ, or are preloaded beside their middles")
    return first.end - first.start


def _along(solver: FilmSolver, ways: Floats, far: Floats) -> Floats:
    """Films (n, 10) on the way to a place (2,)."""
    rows, active = [], None
    for way in ways:
        film = solver.solve(max(way, SMALLEST_WAY) * far, start=active)
        active = film.active
        force = film.force if way > 0.0 else np.zeros(2)
        rows.append(np.concatenate([force, film.stiffness.ravel(), film.damping.ravel()]))
    return np.array(rows)


@cache
def table(profile: str, slenderness: float) -> FilmTable:
    """The table of a bore by name and slenderness L/D: from the kept ones where it is there, else computed."""
    bore = PROFILES[profile]
    kept, name = _kept(), _name(bore, slenderness)
    data = kept[name] if name in kept else computed(bore, slenderness)
    return RoundTable(data) if bore.round else PadsTable(bore, data)


def _name(profile: Profile, slenderness: float) -> str:
    """Name of a table that is kept; bores of pads of the same arc share one."""
    what = profile.name if profile.round else f"pad-{np.degrees(arc(profile)):.0f}"
    return f"{what}-{slenderness:.3f}"


@cache
def _kept() -> dict[str, Floats]:
    if not KEPT.exists():
        return {}
    with np.load(KEPT) as file:
        return {name: file[name].astype(float) for name in file.files}


def main() -> None:
    """Compute all tables that are kept."""
    wanted = [("plain", one) for one in KEPT_SLENDERNESS]
    wanted += [(name, one) for name in PROFILES if name != "plain" for one in (0.5, 0.8)]
    bores = {_name(PROFILES[bore], one): (PROFILES[bore], one) for bore, one in wanted}
    tables = {name: computed(bore, one).astype(np.float32) for name, (bore, one) in bores.items()}
    np.savez_compressed(KEPT, **tables)  # type: ignore[arg-type]  # numpy's stub takes a keyword of its own for them


if __name__ == "__main__":
    main()
