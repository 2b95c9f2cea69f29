"""Settled bearings that a change of a coupling's alignment might be as well, which no data of two bearings a shaft tell apart.

With two bearings a shaft, one that settles moves offset and angle in a fixed proportion (lever rule;
Piotrowski, Shaft Alignment Handbook, CRC Press, 3rd ed. 2006). Where a change's own
covariance allows that proportion, the settlement explains it as well (χ² of what is left, with one degree of freedom).
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats
from estimator.diagnosis.finding_kind import Cause
from estimator.machine.document import Machine
from estimator.statics.alignment import CouplingAlignment, coupling_alignments

PLANES = {"vertical": "elevation_y", "horizontal": "elevation_x"}
"""Elevations by the plane that they lie in."""
SMALLEST = 9.0
"""Least χ² of a plane's change, of offset and angle together, that is looked at [-]."""
LARGEST_LEFT = 3.84
"""Largest χ² that a settlement may leave of it, of one degree of freedom: 95 % [-]."""
NEGLIGIBLE = 1e-9
"""Effect on another coupling's alignment that counts as none [-, 1/m]."""


@dataclass(frozen=True)
class EquivalentSettlement:
    """A bearing whose settlement would be the same as a change of alignment.

    Attributes:
        bearing: Id of the bearing.
        plane: `vertical` or `horizontal`.
        elevation: By how much it would have risen, or moved along +x [m].
    """

    bearing: str
    plane: str
    elevation: float


def equivalent_settlements(machine: Machine, cause: Cause) -> tuple[EquivalentSettlement, ...]:
    """Find the bearings whose settlement by itself explains a change of alignment (lever rule; derived here).

    Source: lever rule, Piotrowski, Shaft Alignment Handbook, CRC Press, 3rd ed. 2006.

    Args:
        machine: The machine.
        cause: A change of the alignment of one of its couplings.

    Returns:
        The settlements, in the order of the planes and bearings.
    """
    alignments = coupling_alignments(machine)
    own = next(one for one in alignments if f"coupling.{one.coupling}" == cause.element)
    others = [one for one in alignments if one is not own]
    return () if own.undefined else tuple(_in_planes(machine, cause, own, others))


def _in_planes(
    machine: Machine, cause: Cause, own: CouplingAlignment, others: list[CouplingAlignment]
) -> Iterator[EquivalentSettlement]:
    by_elevation = np.stack([own.offset, own.angle])
    beside = np.stack([row for one in others for row in (one.offset, one.angle)]) if others else np.zeros((0, len(own.offset)))
    for plane, number in PLANES.items():
        names = [f"bearing.{one.id}.{number}" for one in machine.bearings]
        known = [(place, cause.names.index(name)) for place, name in enumerate(names) if name in cause.names]
        if not known:
            continue
        places, rows = map(list, zip(*known, strict=True))
        lever = by_elevation[:, places]
        change, covariance = lever @ cause.change[rows], lever @ cause.covariance[np.ix_(rows, rows)] @ lever.T
        for place, (left, elevation) in enumerate(_explained(change, covariance, by_elevation.T)):
            if left <= LARGEST_LEFT and not np.any(np.abs(beside[:, place]) > NEGLIGIBLE):
                yield EquivalentSettlement(machine.bearings[place].id, plane, elevation)


def _explained(change: Floats, covariance: Floats, directions: Floats) -> Iterator[tuple[float, float]]:
    """Yield for each direction (2,) what is left of a change (2,) beside it, and how far along it the change lies."""
    size = np.sqrt(np.diag(covariance))
    weight = np.linalg.inv(covariance / np.outer(size, size)) / np.outer(size, size)
    whole = float(change @ weight @ change)
    for direction in directions:
        seen = float(direction @ weight @ direction)
        along = float(direction @ weight @ change)
        yield (np.inf, 0.0) if whole < SMALLEST or seen <= 0.0 else (whole - along**2 / seen, along / seen)
