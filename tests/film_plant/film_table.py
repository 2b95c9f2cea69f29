"""Tables of films over the journal's position, one for each bore and slenderness, and their interpolation.

Where a journal passes the centre of curvature of a lobe, the film there turns within a few hundredths of a clearance, which
these tables smooth: damping and cross-coupled stiffness of three-lobe bores are off by up to 5 % there, while direct solutions
are within 1 % of the estimator's. Some plants on lobes are refused for that.

Forces grow without bound as the film closes: tables hold them times powers of 1 - s², where s is the journal's way to the wall
it moves towards, from 0 to 1.

`python -m tests.film_plant.film_table` computes anew the tables that are kept in tests/data/film-tables.npz, in some minutes.
"""

from dataclasses import dataclass
from functools import cache
from typing import Protocol

import numpy as np
from scipy.interpolate import CubicHermiteSpline, CubicSpline, RectBivariateSpline

from tests.film_plant.arrays import Floats
from tests.film_plant.profile import PROFILES, Profile, reach
from tests.film_plant.reynolds import FilmSolver
from tests.paths import DATA

KEPT = DATA / "film-tables.npz"
"""Tables that are kept."""
KEPT_SLENDERNESS = (0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0)
"""Slenderness L/D of the tables that are kept, for plain bores [-]; others at 0.5 and 0.8."""
ROUND_WAYS = 1.0 - np.exp(-np.linspace(0.0, 3.5, 40))
"""Eccentricities of a table of a round bore [-]: up to 0.97."""
WAYS = 1.0 - np.exp(-np.linspace(0.0, 3.0, 20))
"""Ways to the wall of other tables [-]: up to 0.95."""
DIRECTIONS = 64
"""Directions of other tables, all around."""
FORCE_POWER, STIFFNESS_POWER, DAMPING_POWER = 2, 3, 2
"""Powers of 1 - s² by which tables are multiplied."""
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
        self._force = CubicHermiteSpline(
            ROUND_WAYS, scaled, fade[:, None] ** FORCE_POWER * slope + inner[:, None] * rows[:, :2]
        )
        self._slope = self._force.derivative()
        self._damping = CubicSpline(ROUND_WAYS, fade[:, None] ** DAMPING_POWER * rows[:, 6:])

    def way(self, position: Floats) -> float:
        """Way to the wall: the eccentricity."""
        return float(np.hypot(*position))

    def at(self, position: Floats) -> FilmValues:
        """Film at a position (2,) [clearances]."""
        way = self.way(position)
        if way > ROUND_WAYS[-1]:
            raise OutsideTable(f"eccentricity {way:.3f} is above {ROUND_WAYS[-1]:.3f}")
        fade = 1.0 - way**2
        scaled = self._force(way)
        force = scaled / fade**FORCE_POWER
        slope = self._slope(way) / fade**FORCE_POWER + 2 * FORCE_POWER * way / fade * force
        # The limit in the middle: force there is that of the slope.
        across = force / way if way > 1e-6 else slope
        stiffness = -np.array([[slope[0], -across[1]], [slope[1], across[0]]])
        damping = (self._damping(way) / fade**DAMPING_POWER).reshape(2, 2)
        cosine, sine = position / way if way > 1e-6 else (1.0, 0.0)
        turn = np.array([[cosine, -sine], [sine, cosine]])
        return FilmValues(turn @ force, turn @ stiffness @ turn.T, turn @ damping @ turn.T)


class PositionTable:
    """Film of any bore over way and direction.

    Args:
        profile: The bore.
        grid: Force (2), stiffness (4), damping (4) at `WAYS` and `DIRECTIONS` (ways, directions, 10).
    """

    def __init__(self, profile: Profile, grid: Floats) -> None:
        self.profile = profile
        direction = directions()
        around = np.arange(-BEYOND, DIRECTIONS + BEYOND)
        angle = direction[0] + 2 * np.pi / DIRECTIONS * around
        fade = (1.0 - WAYS**2)[:, None]
        powers = [FORCE_POWER] * 2 + [STIFFNESS_POWER] * 4 + [DAMPING_POWER] * 4
        self._splines = [
            RectBivariateSpline(WAYS, angle, fade**power * grid[:, around % DIRECTIONS, k]) for k, power in enumerate(powers)
        ]
        self._powers = np.array(powers)

    def way(self, position: Floats) -> float:
        """Way to the wall that the journal moves towards, from 0 to 1 [-]."""
        direction = np.array([np.arctan2(position[1], position[0])])
        return float(np.hypot(*position) / reach(self.profile, direction)[0])

    def at(self, position: Floats) -> FilmValues:
        """Film at a position (2,) [clearances]."""
        way = self.way(position)
        if way > WAYS[-1]:
            raise OutsideTable(f"the journal's way to the wall, {way:.3f}, is above {WAYS[-1]:.3f}")
        direction = float(np.arctan2(position[1], position[0]))
        scaled = np.array([spline(np.array([way]), np.array([direction]), grid=False)[0] for spline in self._splines])
        found = scaled / (1.0 - way**2) ** self._powers
        return FilmValues(found[:2], found[2:6].reshape(2, 2), found[6:].reshape(2, 2))


def directions() -> Floats:
    """Directions of a table (DIRECTIONS,) [rad], from -π on."""
    return np.linspace(-np.pi, np.pi, DIRECTIONS, endpoint=False)


def computed(profile: Profile, slenderness: float) -> Floats:
    """Solve for a table: rows (n, 10) of a round bore, else a grid (ways, directions, 10)."""
    if profile.round:
        solver = FilmSolver(profile, slenderness, around=720, along=20)
        return _along(solver, ROUND_WAYS, np.array([1.0, 0.0]))
    solver = FilmSolver(profile, slenderness, around=240, along=12)
    angle = directions()
    far = reach(profile, angle)
    rays = [_along(solver, WAYS, r * np.array([np.cos(a), np.sin(a)])) for a, r in zip(angle, far, strict=True)]
    return np.stack(rays, axis=1)


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
    name = f"{profile}-{slenderness:.3f}"
    kept = _kept()
    data = kept[name] if name in kept else computed(PROFILES[profile], slenderness)
    return RoundTable(data) if PROFILES[profile].round else PositionTable(PROFILES[profile], data)


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
    tables = {f"{name}-{one:.3f}": computed(PROFILES[name], one).astype(np.float32) for name, one in wanted}
    np.savez_compressed(KEPT, **tables)  # type: ignore[arg-type]  # numpy's stub takes a keyword of its own for them


if __name__ == "__main__":
    main()
