"""Mesh of a train's shafts: the stations of their nodes and the number of elements between them."""

import numpy as np

from estimator.arrays import Floats
from estimator.machine.document import Machine
from estimator.machine.films import StaticLoad
from estimator.machine.parts import STATION_TOLERANCE, Bearing, Disc, Probe, Seal, Shaft

DEFAULT_ELEMENTS_PER_SHAFT = 12
"""Number of elements whose length is the longest one allowed, where the document gives no element length."""


def node_stations(machine: Machine, shaft: Shaft) -> Floats:
    """Place the nodes of a shaft: section ends, every part's place, and enough between for the element length.

    Args:
        machine: The machine.
        shaft: One of its shafts.

    Returns:
        Stations of the nodes (n,), ascending [m].
    """
    fixed, counts = _spans(machine, shaft)
    pieces = [np.array(fixed[:1])]
    for start, stop, count in zip(fixed[:-1], fixed[1:], counts, strict=True):
        pieces.append(np.linspace(start, stop, count + 1)[1:])
    return np.concatenate(pieces)


def element_count(machine: Machine, shaft: Shaft) -> int:
    """Count a shaft's elements without making them.

    Args:
        machine: The machine.
        shaft: One of its shafts.

    Returns:
        Number of elements.
    """
    return sum(_spans(machine, shaft)[1])


def _spans(machine: Machine, shaft: Shaft) -> tuple[list[float], list[int]]:
    """Compute the stations [m] at which a node must be, and the number of elements from each to the next."""
    ends = np.concatenate([[0.0], np.cumsum([section.length for section in shaft.sections])])
    parts: list[Disc | Bearing | Seal | StaticLoad | Probe] = [
        *machine.discs,
        *machine.bearings,
        *machine.seals,
        *machine.static_loads,
        *machine.probes,
    ]
    places = [part.station for part in parts if part.shaft == shaft.id]
    wanted = np.unique(np.concatenate([ends, np.minimum(places, ends[-1])]))
    fixed = [0.0]
    for station in wanted:
        if station - fixed[-1] > STATION_TOLERANCE:
            fixed.append(float(station))
    longest = machine.element_length or ends[-1] / DEFAULT_ELEMENTS_PER_SHAFT
    # A hair of slack keeps a span of exactly the longest length in one piece.
    counts = [max(1, int(np.ceil((stop - start) / longest - 1e-6))) for start, stop in zip(fixed[:-1], fixed[1:], strict=True)]
    return fixed, counts
