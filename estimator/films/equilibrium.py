"""Positions at which a film carries a static load.

The load acts on the journal, in any direction: a weight W is (0, -W). Newton's method with the exact stiffness starts from the
best of some hundred positions that are tabulated for each film, and never leaves the film. It needs no sequence of loads, and
finds a nearly unloaded journal as well as one close to the wall. Damping of the steps as in P. Deuflhard, Newton Methods for
Nonlinear Problems, Springer, 2004.
"""

import numpy as np

from estimator.arrays import Bools, Floats
from estimator.errors import Invalid
from estimator.films.film import FilmOverPosition
from estimator.films.pad_table import THINNEST_KNOWN

_DIRECTIONS = 36
_DISTANCES = np.array([1e-4, 1e-3, 0.01, 0.03, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.88, 0.94, 0.97, 0.99])
_STEPS, _HALVINGS, _STARTS = 60, 30, 6
_RESIDUAL = 1e-11


class FilmOverloaded(Invalid):
    """Raised when films carry their loads nowhere where they are known; `carried` says which of them do."""

    def __init__(self, text: str, carried: Bools) -> None:
        """Make the error.

        Args:
            text: Statement of the first such load.
            carried: Which loads are carried (...).
        """
        super().__init__(text)
        self.carried = carried


class EquilibriumSearch:
    """Search for positions of equilibrium in one film, in units of the clearance c and of the force μ ω R L (R/c)²."""

    def __init__(self, film: FilmOverPosition) -> None:
        """Prepare the search by a survey of the film.

        Args:
            film: The film.
        """
        self.film = film
        angle = np.arange(_DIRECTIONS) * (2.0 * np.pi / _DIRECTIONS) + 0.01
        ray = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        reach = _reach(film, ray)
        places = (ray * reach[:, None])[:, None] * _DISTANCES[:, None]
        self._survey = np.concatenate([np.zeros((1, 2)), places.reshape(-1, 2)])
        self._forces = film.at(self._survey).force

    def position(self, load: Floats, *, start: Floats | None = None) -> Floats:
        """Find the position of equilibrium under each load.

        Source: P. Deuflhard, Newton Methods for Nonlinear Problems, Springer, 2004.

        Args:
            load: Loads (..., 2) on the journal [μ ω R L (R/c)²].
            start: Positions (..., 2) from which to search first, such as those under loads not far from these [c]; None for
                those of the film's survey only.

        Returns:
            Positions (..., 2) [c].

        Raises:
            FilmOverloaded: A load is not carried.
        """
        given = np.asarray(load, dtype=float)
        loads = given.reshape(-1, 2)
        found = np.full(loads.shape, np.nan)
        if start is not None:
            places = np.broadcast_to(start, given.shape).reshape(-1, 2)
            known = self.film.covers(places)
            found[known] = self._newton(loads[known], places[known])
        order = self._nearest(loads)
        for attempt in range(_STARTS):
            missing = np.isnan(found[:, 0])
            if not missing.any():
                break
            found[missing] = self._newton(loads[missing], self._survey[order[missing, attempt]])
        carried = ~np.isnan(found[:, 0])
        if not carried.all():
            raise FilmOverloaded(_overload(loads[~carried][0]), carried.reshape(given.shape[:-1]))
        return found.reshape(given.shape)

    def _nearest(self, loads: Floats) -> np.ndarray[tuple[int, ...], np.dtype[np.intp]]:
        """Return the surveyed positions (n, starts) whose forces come closest to carrying the loads."""
        missing = np.linalg.norm(self._forces + loads[:, None], axis=-1)
        size = np.linalg.norm(self._forces, axis=-1) + np.linalg.norm(loads, axis=-1)[:, None]
        relative = missing / np.where(size > 0.0, size, 1.0)
        return np.asarray(np.argsort(relative, axis=1, kind="stable")[:, :_STARTS])

    def _newton(self, loads: Floats, start: Floats) -> Floats:
        """Return the positions (n, 2) to which Newton's method leads, NaN where it ends elsewhere."""
        place = np.array(start)
        state = self.film.at(place)
        force, stiffness = state.force, state.static_stiffness
        wanted = np.linalg.norm(loads, axis=-1)
        left = np.arange(len(loads))
        for _ in range(_STEPS):
            residual = np.linalg.norm(force + loads, axis=-1)
            left = left[residual[left] > _RESIDUAL * wanted[left]]
            if not left.size:
                break
            step = _step(stiffness[left], force[left] + loads[left])
            moved = self._shortened(place[left], step, loads[left], residual[left])
            place[left[moved >= 0.0]] += (moved[:, None] * step)[moved >= 0.0]
            settled = np.linalg.norm(moved[:, None] * step, axis=-1) < 1e-15
            left = left[(moved >= 0.0) & ~settled]
            if left.size:
                state = self.film.at(place[left])
                force[left], stiffness[left] = state.force, state.static_stiffness
        balanced = np.linalg.norm(force + loads, axis=-1) <= 1e-8 * wanted + 1e-14
        return np.where(balanced[:, None], place, np.nan)

    def _shortened(self, place: Floats, step: Floats, loads: Floats, residual: Floats) -> Floats:
        """Return the parts of the steps (n,) that stay in the film and reduce the residual, -1 where none does."""
        part = np.full(len(place), -1.0)
        for halving in range(_HALVINGS):
            open_ = np.flatnonzero(part < 0.0)
            tried = place[open_] + 0.5**halving * step[open_]
            inside = self.film.covers(tried)
            open_, tried = open_[inside], tried[inside]
            if open_.size:
                left = np.linalg.norm(self.film.at(tried).force + loads[open_], axis=-1)
                part[open_[left < residual[open_]]] = 0.5**halving
            if (part >= 0.0).all():
                break
        return part


def _step(stiffness: Floats, unbalanced: Floats) -> Floats:
    """Return Newton's steps (n, 2), or small ones along the force where the stiffness is singular."""
    determinant = np.linalg.det(stiffness)
    singular = np.abs(determinant) < 1e-14 * np.abs(stiffness).max(axis=(1, 2)) ** 2
    matrix = np.where(singular[:, None, None], np.eye(2), stiffness)
    step = np.linalg.solve(matrix, unbalanced[..., None])[..., 0]
    size = np.linalg.norm(step, axis=-1, keepdims=True)
    return np.asarray(step * np.minimum(1.0, 0.5 / np.maximum(size, 1e-300)))


def _reach(film: FilmOverPosition, ray: Floats) -> Floats:
    """Return how far the journal can go along each ray (n, 2) from the bearing's centre (n,)."""
    low, high = np.zeros(len(ray)), np.full(len(ray), 2.0)
    for _ in range(40):
        middle = (low + high) / 2.0
        inside = film.covers(middle[:, None] * ray)
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    return low


def _overload(load: Floats) -> str:
    """State what is wrong with a load (2,)."""
    size, direction = float(np.hypot(*load)), float(np.degrees(np.arctan2(load[1], load[0])))
    return (
        f"a load of {size:.4g} μωRL(R/c)² at {direction:.0f}° (Sommerfeld number {1.0 / (np.pi * size):.4g}): the film that "
        f"carries it would be thinner than {THINNEST_KNOWN:g} of the clearance; the speed is too low or the load too high"
    )
