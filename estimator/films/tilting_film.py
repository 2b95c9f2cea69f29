"""Film of a tilting-pad bearing: the sum over its pads, each of which pushes the journal along the line through its pivot.

Stiffness and damping are those that a motion at the spin speed meets (λ = iω), with the pads tilting at that frequency: what
the synchronous response needs. Pads without inertia on frictionless pivots couple x and y alike: kxy = kyx, cxy = cyx.
"""

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from estimator.arrays import Bools, Floats
from estimator.films.film import FilmCoefficients, require_covered, slenderness_within
from estimator.films.pad import FULL_ARC, InvalidPad
from estimator.films.pivoted_pad_table import PivotedPadTable, pivoted_pad_table
from estimator.films.tilted_pads import TiltedPads

FOREMOST_PIVOT, HINDMOST_PIVOT = 0.4, 0.8
"""Places between which a pivot lies, as parts of the arc from the leading edge [-]."""
LARGEST_PRELOAD = 0.8
"""Largest preload of tilting pads [-]."""
FEWEST_PADS, MOST_PADS = 3, 12
"""Numbers of pads between which bearings have them."""


class PivotedTableMaker(Protocol):
    """Function that returns the table of a tilting pad."""

    def __call__(self, *, arc: float, pivot: float, slenderness: float) -> PivotedPadTable:
        """Return the table of an arc [rad], a pivot as part of it [-] and a ratio of length to diameter [-]."""


@dataclass(frozen=True)
class TiltingProfile:
    """Equal tilting pads, evenly around the journal.

    Angles run from the horizontal x towards y, as the journal turns.

    Attributes:
        count: Number of pads.
        arc: Arc of each pad [rad].
        preload: How much closer the pivots are than those of pads that fit the bearing's circle, in the pads' clearances [-].
        pivot: Place of the pivot as a part of the arc, from the leading edge; 0.5 for the middle [-].
        first: Direction of one pivot [rad].
    """

    count: int
    arc: float
    preload: float = 0.0
    pivot: float = 0.5
    first: float = -math.pi / 2.0

    def __post_init__(self) -> None:
        if not FEWEST_PADS <= self.count <= MOST_PADS:
            raise InvalidPad(f"{self.count} tilting pads: a bearing has {FEWEST_PADS} to {MOST_PADS}")
        if self.arc < 0.2 or self.count * self.arc > FULL_ARC * (1.0 + 1e-9):
            raise InvalidPad(
                f"{self.count} tilting pads of {math.degrees(self.arc):g}°: each must have at least 11° and all together at "
                "most 360°, or they overlap"
            )
        if not 0.0 <= self.preload <= LARGEST_PRELOAD:
            raise InvalidPad(f"a preload of {self.preload:g}: tilting pads have 0 to {LARGEST_PRELOAD:g}")
        if not FOREMOST_PIVOT <= self.pivot <= HINDMOST_PIVOT:
            raise InvalidPad(
                f"a pivot at {self.pivot:g} of the arc: it must lie at {FOREMOST_PIVOT:g} to {HINDMOST_PIVOT:g}, 0.5 being "
                "the middle"
            )

    @property
    def axes(self) -> Floats:
        """Return the directions of the pivots (n, 2) [-]."""
        angle = self.first + np.arange(self.count) * (FULL_ARC / self.count)
        return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


class TiltingFilm:
    """Film of a tilting-pad bearing over the journal's position; interface and units as of `Film`."""

    def __init__(self, profile: TiltingProfile, slenderness: float, *, table: PivotedTableMaker = pivoted_pad_table) -> None:
        """Make the table of its pads, or take one made before; one takes seconds.

        Args:
            profile: The pads.
            slenderness: Length over diameter [-].
            table: Function that returns the table of a pad.

        Raises:
            InvalidSlenderness: No bearing has this slenderness.
        """
        self._axes, self._preload = profile.axes, profile.preload
        self._table = table(
            arc=round(profile.arc, 12), pivot=round(profile.pivot, 12), slenderness=slenderness_within(slenderness)
        )

    def covers(self, position: Floats) -> Bools:
        """Return where the film is known: on no pad thinner than three hundredths of the clearance.

        Args:
            position: Positions (..., 2) [c].

        Returns:
            Whether it is (...).
        """
        return np.asarray(self._table.covers(self._towards(position)).all(axis=-1))

    def thinnest(self, position: Floats) -> Floats:
        """Compute the thickness of the film where it is thinnest, the pads tilted as they will.

        Args:
            position: Positions (..., 2) [c].

        Returns:
            Thicknesses (...), negative where the journal would be in a pad [c].
        """
        return np.asarray(self._table.thinnest(self._towards(position)).min(axis=-1))

    def at(self, position: Floats) -> FilmCoefficients:
        """Compute forces, synchronous coefficients and their derivatives, and the pads that they come from.

        Args:
            position: Positions (..., 2) of the journal relative to the bearing's centre [c].

        Returns:
            The film at those positions.

        Raises:
            OutsideFilm: The film is not known at one of the positions.
        """
        position = np.asarray(position, dtype=float)
        require_covered(self, position)
        pads = self._table.at(self._towards(position))
        synchronous, slope = pads.reduced(1j)
        n = self._axes

        def along(values: Floats, to: str) -> Floats:
            return np.asarray(np.einsum(f"...n,n{',n'.join(to)}->...{to}", values, *([n] * len(to))))

        return FilmCoefficients(
            force=along(-pads.push, "i"),
            stiffness=along(synchronous.real, "ij"),
            damping=along(synchronous.imag, "ij"),
            stiffness_slope=along(slope.real, "ijk"),
            damping_slope=along(slope.imag, "ijk"),
            pads=TiltedPads(
                np.broadcast_to(n, (*pads.push.shape, 2)), pads.stiffness, pads.damping, pads.weight, pads.push_slope
            ),
        )

    def _towards(self, position: Floats) -> Floats:
        """Return the distances (..., n) of the journal from the pads' centres of curvature towards their pivots."""
        return np.asarray(position, dtype=float) @ self._axes.T + self._preload
