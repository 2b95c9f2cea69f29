"""Coordinates that a named cause has moved: a change of alignment must not hold them at the baseline's.

Of a worn bearing, say, the clearance is another one than in the baseline. Held there, the elevations of its bearing would have
to explain what the wear does. What a kind of cause moves stands in the declaration of its finding.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats
from estimator.fit.problem.coordinates import Coordinates
from estimator.machine.parameter_description import ParameterDescription, describe

FREED = 3.0
"""Standard deviation of what a cause has moved, in those of what the document believes of its value [-]."""


@dataclass(frozen=True)
class MovedCoordinates:
    """Coordinates of a train on oil films that a kind of cause moves, beside elevations.

    Attributes:
        quantities: Quantities of its element.
        coefficients: Whether it moves coefficients of its element, or a film's deviations from its model.
        of_all_elements: Whether it moves those quantities of all elements, together, as warmer oil does.
    """

    quantities: tuple[str, ...] = ()
    coefficients: bool = False
    of_all_elements: bool = False


MovingCause = tuple[str, MovedCoordinates]
"""Element of a cause that a diagnosis has named, and what it moves."""


def freed_directions(coordinates: Coordinates, causes: Iterable[MovingCause]) -> Floats:
    """Return the directions that named causes have moved, beside elevations (derived here).

    Args:
        coordinates: The n coordinates of a train on oil films.
        causes: Element of each cause, and what it moves.

    Returns:
        Directions (n, m), each as long as the standard deviation of the change along it [-].
    """
    described = [describe(name) for name in coordinates.names]
    groups: dict[tuple[int, ...], None] = {}
    for element, moved in causes:
        own = [place for place, said in enumerate(described) if _moves(element, moved, said)]
        groups |= dict.fromkeys(_together(own) if moved.of_all_elements else [(place,) for place in own])
    directions = np.zeros((coordinates.size, len(groups)))
    for column, group in enumerate(groups):
        directions[list(group), column] = FREED * float(coordinates.spread[list(group)].min())
    return directions


def _together(places: Sequence[int]) -> list[tuple[int, ...]]:
    return [tuple(places)] if places else []


def _moves(element: str, moved: MovedCoordinates, said: ParameterDescription) -> bool:
    """Return whether a cause at an element moves a coordinate."""
    if said.quantity in moved.quantities:
        return moved.of_all_elements or said.element == element
    film = f"bearing.{said.element_id}" if said.element_kind == "films" else None
    return moved.coefficients and element in (film, said.element if said.term is not None else None)
