"""Coordinates that a named cause has moved: a change of alignment must not hold them at the baseline's.

Of a worn bearing, say, the clearance is another one than in the baseline. Held there, the elevations of its bearing would have
to explain what the wear does. Each kind of cause moves here what its hypothesis moves in the diagnosis.
"""

from collections.abc import Iterable, Sequence

import numpy as np

from estimator.alignment.healthy_films import VISCOSITIES
from estimator.arrays import Floats
from estimator.fit.problem.coordinates import Coordinates
from estimator.machine.parameter_description import ROTATING_ERRORS, ParameterDescription, describe

FREED = 3.0
"""Standard deviation of what a cause has moved, in those of what the document believes of its value [-]."""
QUANTITIES: dict[str, tuple[str, ...]] = {
    "wear": ("clearance",),
    "unbalance": ("unbalance",),
    "rotating_coupling": ROTATING_ERRORS,
    "process_force": ("force_x", "force_y"),
}
"""Quantities of its element that a cause of a kind moves."""
COEFFICIENTS = ("pedestal", "coupling", "bearing")
"""Kinds of causes that move coefficients of their element, or a film's deviations from its model."""

NamedCause = tuple[str, str]
"""Kind and element of a cause that a diagnosis has named, such as `wear` of `bearing.B2`."""


def freed_directions(coordinates: Coordinates, causes: Iterable[NamedCause]) -> Floats:
    """Return the directions that named causes have moved, beside elevations (derived here).

    Args:
        coordinates: The n coordinates of a train on oil films.
        causes: Kind and element of each cause.

    Returns:
        Directions (n, m), each as long as the standard deviation of the change along it [-].
    """
    described = [describe(name) for name in coordinates.names]
    groups: dict[tuple[int, ...], None] = {}
    for kind, element in causes:
        own = [place for place, said in enumerate(described) if _moves(kind, element, said)]
        # All films have warmer oil together; whatever else a cause moves, it moves each by itself.
        groups |= dict.fromkeys(_together(own) if kind == "oil" else [(place,) for place in own])
    directions = np.zeros((coordinates.size, len(groups)))
    for column, group in enumerate(groups):
        directions[list(group), column] = FREED * float(coordinates.spread[list(group)].min())
    return directions


def _together(places: Sequence[int]) -> list[tuple[int, ...]]:
    return [tuple(places)] if places else []


def _moves(kind: str, element: str, said: ParameterDescription) -> bool:
    """Return whether a cause moves a coordinate."""
    if kind == "oil":
        return said.quantity in VISCOSITIES
    if kind in COEFFICIENTS:
        film = f"bearing.{said.element_id}" if said.element_kind == "films" else None
        return element in (film, said.element if said.term is not None else None)
    return said.element == element and said.quantity in QUANTITIES.get(kind, ())
