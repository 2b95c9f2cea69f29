"""Reynolds' equation by finite volumes, with film rupture as a complementarity problem.

In units of c for the film, of R for the angle, of half the length for the axial coordinate and of μω(R/c)² for the pressure:

    ∂/∂θ(h³ ∂p/∂θ) + (D/L)² ∂/∂ζ(h³ ∂p/∂ζ) = 6 ∂h/∂θ + 12 ∂h/∂t,    p ≥ 0, and where p > 0 it holds.

Cells balance the flow through their faces; half of the bearing is enough. Which cells carry pressure is found by a primal-dual
active set (Hintermüller, Ito, Kunisch, SIAM J. Optim. 13 (2003) 865), exactly and not by iterating pressures. At the edge of
the film pressure and gradient vanish, so that the edge's own motion does not enter the first-order perturbation (Lund and
Thomsen 1978): stiffness and damping are exact derivatives of the discrete force as long as no cell changes sides.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from tests.film_plant.arrays import Booleans, Floats, Indices
from tests.film_plant.profile import Pad, Profile, thickness

Field = Callable[[Pad, Floats], Floats]
"""Function of a pad and of angles (n,) on it [rad] that returns a field over them (n,)."""

MOST_CHANGES = 300
"""Most changes of the active set before it is given up."""
FEWEST_ALONG = 8
"""Fewest cells along half of the length of a mesh whose film is looked for on a mesh of half as many cells first."""


@dataclass(frozen=True)
class Film:
    """Film at one position of the journal.

    Attributes:
        force: Force on the journal (2,) [μωRL(R/c)²].
        stiffness: Stiffness (2, 2), force = -K x [μωRL(R/c)²/c].
        damping: Damping (2, 2), force = -C ẋ [μRL(R/c)²/c].
        active: Cells that carry pressure (cells around, cells along).
    """

    force: Floats
    stiffness: Floats
    damping: Floats
    active: Booleans


@dataclass(frozen=True)
class _Thickness:
    """A field over the cells' middles (n,), their entering and their leaving faces (n,)."""

    middle: Floats
    entry: Floats
    exit: Floats


class FilmSolver:
    """Solver of one geometry.

    Args:
        profile: The bore.
        slenderness: Length over diameter L/D [-].
        around: Cells around.
        along: Cells along half of the length.
        rupture: Whether the film ruptures where the pressure would be negative; without, Sommerfeld's full film.
    """

    def __init__(
        self, profile: Profile, slenderness: float, *, around: int = 360, along: int = 16, rupture: bool = True
    ) -> None:
        self.profile = profile
        self.rupture = rupture
        self.along = along
        self._slenderness = slenderness
        self._axial = 1.0 / slenderness**2
        arcs = np.array([pad.end - pad.start for pad in profile.pads])
        self._cells = [max(8, round(around * arc / arcs.sum())) for arc in arcs]
        self._width = np.concatenate([np.full(n, arc / n) for n, arc in zip(self._cells, arcs, strict=True)])
        starts = [pad.start + arc / n * np.arange(n) for pad, arc, n in zip(profile.pads, arcs, self._cells, strict=True)]
        self._entry = np.concatenate(starts)
        self.angle = self._entry + self._width / 2

    def solve(self, position: Floats, *, start: Booleans | None = None) -> Film:
        """Solve for the film with the journal at rest at a position (2,) [clearances]; `start` may name active cells."""
        film = self._film(lambda pad, angle: thickness(pad, angle, position))
        if min(film.middle.min(), film.entry.min()) <= 0.0:
            raise ValueError(f"the journal touches the bearing at {position} clearances")
        cubed = _Thickness(film.middle**3, film.entry**3, film.exit**3)
        flow = self._conductance(cubed)
        wedge = self._columns(-6.0 * (film.exit - film.entry))
        pressure, active = self._complementary(flow, wedge, self._coarser_film(position) if start is None else start)
        inside = np.flatnonzero(active)
        sources = np.stack([*self._displaced(film, pressure), *self._moving()], axis=1)
        change = np.zeros((active.size, 4))
        change[inside] = _solved(flow, inside, sources)
        forces = self._force(change)
        return Film(self._force(pressure), -forces[:, :2], -forces[:, 2:], active.reshape(-1, self.along))

    def pressure(self, position: Floats) -> Floats:
        """Pressure in the cells (around, along) at a position (2,) [μω(R/c)²]."""
        film = self._film(lambda pad, angle: thickness(pad, angle, position))
        flow = self._conductance(_Thickness(film.middle**3, film.entry**3, film.exit**3))
        found, _ = self._complementary(flow, self._columns(-6.0 * (film.exit - film.entry)), self._coarser_film(position))
        return found.reshape(-1, self.along)

    def _coarser_film(self, position: Floats) -> Booleans | None:
        """Cells (around, along) that carry pressure on a mesh of half as many: nearly those of this one, found sooner."""
        if not self.rupture or self._coarser is None:
            return None
        carrying = self._coarser.pressure(position) > 0.0
        return np.asarray(carrying.repeat(2, axis=0).repeat(2, axis=1))

    @cached_property
    def _coarser(self) -> "FilmSolver | None":
        """Solver with half as many cells either way, where there is one."""
        around = int(sum(self._cells))
        if self.along < FEWEST_ALONG or self.along % 2 or around % 2:
            return None
        half = FilmSolver(self.profile, self._slenderness, around=around // 2, along=self.along // 2)
        return half if [2 * one for one in half._cells] == self._cells else None

    def _film(self, field: Field) -> _Thickness:
        """A field over angles of each pad at middles and faces."""
        edges = np.cumsum([0, *self._cells])
        parts = [(pad, slice(first, last)) for pad, first, last in zip(self.profile.pads, edges[:-1], edges[1:], strict=True)]
        middle = np.concatenate([field(pad, self.angle[cells]) for pad, cells in parts])
        entry = np.concatenate([field(pad, self._entry[cells]) for pad, cells in parts])
        exit_ = np.concatenate([field(pad, self._entry[cells] + self._width[cells]) for pad, cells in parts])
        return _Thickness(middle, entry, exit_)

    @cached_property
    def _links(self) -> tuple[Floats, Floats]:
        """Return which cell follows each one around, -1 where the pad ends, and which goes before it."""
        after: list[int] = []
        first = 0
        for pad, count in zip(self.profile.pads, self._cells, strict=True):
            after += [*range(first + 1, first + count), first if pad.whole else -1]
            first += count
        following = np.array(after)
        before = np.full(following.size, -1)
        before[following[following >= 0]] = np.flatnonzero(following >= 0)
        return following, before

    def _conductance(self, cubed: _Thickness) -> sp.csr_array:
        """Matrix from pressures to the net flow out of each cell, linear in the field that stands for h³."""
        following, before = self._links
        n = following.size
        leaving = cubed.exit / self._width * np.where(following >= 0, 1.0, 2.0)
        entering = cubed.entry / self._width * np.where(before >= 0, 1.0, 2.0)
        cell = np.flatnonzero(following >= 0)
        link = sp.coo_array((-leaving[cell], (cell, following[cell])), shape=(n, n))
        around = sp.diags_array(leaving + entering) + link + link.T
        edge = np.full(self.along, 2.0)
        edge[0], edge[-1] = 1.0, 3.0
        beside = np.diag(np.ones(self.along - 1), 1)
        axial = sp.csr_array((np.diag(edge) - beside - beside.T) * self.along)
        sideways = sp.diags_array(cubed.middle * self._width * self._axial)
        whole = sp.kron(around, sp.eye_array(self.along) / self.along) + sp.kron(sideways, axial)
        return sp.csr_array(whole)

    def _complementary(self, flow: sp.csr_array, wedge: Floats, start: Booleans | None) -> tuple[Floats, Booleans]:
        """Pressure with p ≥ 0, flow p - wedge ≥ 0 and one of both zero in each cell."""
        active = np.ones(wedge.size, bool) if start is None or not self.rupture else start.ravel().copy()
        pressure = np.zeros(wedge.size)
        for _ in range(MOST_CHANGES):
            inside = np.flatnonzero(active)
            pressure[:] = 0.0
            pressure[inside] = _solved(flow, inside, wedge)
            if not self.rupture:
                return pressure, active
            new = np.where(active, pressure > 0.0, wedge - flow @ pressure > 0.0)
            if np.array_equal(new, active):
                return pressure, active
            active = new
        raise RuntimeError(f"the film's edge was not found within {MOST_CHANGES} changes")

    def _displaced(self, film: _Thickness, pressure: Floats) -> list[Floats]:
        """Sources of the perturbed pressure when the journal is moved along x and along y."""
        found = []
        for quarter in (0.0, np.pi / 2):
            change = self._film(partial(_approach, quarter))
            cubed = _Thickness(
                3.0 * film.middle**2 * change.middle, 3.0 * film.entry**2 * change.entry, 3.0 * film.exit**2 * change.exit
            )
            found.append(self._columns(-6.0 * (change.exit - change.entry)) - self._conductance(cubed) @ pressure)
        return found

    def _moving(self) -> list[Floats]:
        """Sources of the perturbed pressure when the journal moves along x and along y, per ω."""
        return [self._columns(12.0 * np.cos(self.angle - quarter) * self._width) for quarter in (0.0, np.pi / 2)]

    def _columns(self, flow: Floats) -> Floats:
        """A flow per unit of length around, in every cell along."""
        return np.repeat(flow / self.along, self.along)

    def _force(self, pressure: Floats) -> Floats:
        """Force on the journal (2, …) of pressures (cells, …)."""
        around = pressure.reshape(self.angle.size, self.along, -1).mean(axis=1) * self._width[:, None]
        return np.asarray(-np.stack([np.cos(self.angle) @ around, np.sin(self.angle) @ around])).reshape(
            2, *pressure.shape[1:]
        )


def _approach(direction: float, _: Pad, angle: Floats) -> Floats:
    """Change of the film's thickness when the journal moves in a direction [rad]."""
    return np.asarray(-np.cos(angle - direction))


def _solved(flow: sp.csr_array, inside: Indices, sources: Floats) -> Floats:
    """Pressures in some cells (n, …) that balance sources in all (cells, …); the others' are zero."""
    if not inside.size:
        return sources[inside]
    # Cells are numbered along first: the matrix is a narrow band as it stands.
    factor = splu(
        flow[inside][:, inside].tocsc(), permc_spec="NATURAL", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
    )
    return np.asarray(factor.solve(sources[inside]))
