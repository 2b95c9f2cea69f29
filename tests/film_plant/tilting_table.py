"""Tables of tilting-pad bearings: a pad's push and dynamic stiffness over the journal's distance towards its pivot."""

from functools import cache

import numpy as np
from scipy.interpolate import CubicSpline

from tests.film_plant.arrays import Floats
from tests.film_plant.film_table import FilmTable, FilmValues, OutsideTable, table
from tests.film_plant.tilting import TILTING, RockerPads, balanced

NEAREST, FARTHEST, PLACES = 0.92, -1.2, 60
"""Distances of the journal towards a pad's pivot between which its film is tabulated [clearances], and their number."""
POWERS = np.array([2, 3, 3, 3])
"""Powers of the way that is left to the pad by which push, slow stiffness, stiffness and damping are multiplied."""
FIRST_TILT = 0.2
"""Tilt from which that of the most loaded pad is looked for [clearances]."""


class PadRow:
    """Push, slow stiffness, stiffness and damping at the spin speed of one pad.

    Args:
        pads: The bearing.
        slenderness: L/D [-].
    """

    def __init__(self, pads: RockerPads, slenderness: float) -> None:
        share = np.linspace(0.0, 1.0, PLACES)
        places, rows, tilt = [], [], FIRST_TILT
        for place in (NEAREST + (FARTHEST - NEAREST) * share * (0.25 + 0.75 * share)).tolist():
            found = balanced(pads, slenderness, place, tilt)
            if found is None:
                break
            tilt, film = found
            z = film.stiffness + 1j * film.damping
            (nn, nt), (tn, tt) = film.stiffness
            reduced = z[0, 0] - z[0, 1] * z[1, 0] / z[1, 1]
            places.append(place)
            rows.append([-film.force[0], nn - nt * tn / tt, reduced.real, reduced.imag])
        self.last = places[-1]
        left = 1.0 - np.array(places[::-1])
        self._spline = CubicSpline(places[::-1], left[:, None] ** POWERS * np.array(rows[::-1]))

    def at(self, place: Floats) -> Floats:
        """Values (n, 4) at distances (n,) [clearances]; zero where the pad carries nothing."""
        found = self._spline(np.maximum(place, self.last)) / (1.0 - np.maximum(place, self.last)[:, None]) ** POWERS
        return np.asarray(np.where(place[:, None] >= self.last, found, 0.0))


class TiltingTable:
    """Film of a tilting-pad bearing.

    Args:
        pads: The bearing.
        row: Its pads' values.
    """

    def __init__(self, pads: RockerPads, row: PadRow) -> None:
        self._axes = np.stack([np.cos(pads.directions), np.sin(pads.directions)], axis=-1)
        self._preload, self._row = pads.preload, row

    def way(self, position: Floats) -> float:
        """Return how close the journal is to the pad that it is closest to, from the preload to 1 [-]."""
        return float(np.max(self._axes @ position) + self._preload)

    def at(self, position: Floats) -> FilmValues:
        """Film at a position (2,) [clearances]."""
        towards = self._axes @ position + self._preload
        if towards.max() > NEAREST:
            raise OutsideTable(f"a pad's film with the journal {towards.max():.3f} towards it is not tabulated")
        push, slow, stiffness, damping = self._row.at(towards).T
        matrices = [np.einsum("n,ni,nj->ij", one, self._axes, self._axes) for one in (stiffness, damping, slow)]
        return FilmValues(-push @ self._axes, *matrices)


@cache
def bearing_table(profile: str, slenderness: float) -> FilmTable:
    """The table of a bearing by name and slenderness L/D; that of tilting pads takes some seconds."""
    if profile in TILTING:
        return TiltingTable(TILTING[profile], _pad_row(TILTING[profile], slenderness))
    return table(profile, slenderness)


@cache
def _pad_row(pads: RockerPads, slenderness: float) -> PadRow:
    return PadRow(pads, slenderness)
