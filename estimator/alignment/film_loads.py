"""Static loads on the oil films of a train at running speed, with their errors, as a part of what a bearing may carry.

Highest specific pressure: white metal of lead or tin, ISO 7902-3:2020, 5 MPa.
"""

from dataclasses import dataclass

from estimator.machine.bearings_on_films import bearings_on_films
from estimator.updated_model.bearing_loads import bearing_loads
from estimator.updated_model.films_over_couplings import films_over_couplings
from estimator.updated_model.model import UpdatedModel

HIGHEST_PRESSURE = 5e6
"""Highest load over diameter and length [Pa]."""


@dataclass(frozen=True)
class FilmLoad:
    """Load on one film.

    Attributes:
        bearing: Id of the bearing.
        vertical: Its vertical load, upwards on the journal [N].
        error: Standard error of that [N].
        area: Diameter times length [m²].
    """

    bearing: str
    vertical: float
    error: float
    area: float


def film_loads(model: UpdatedModel) -> tuple[FilmLoad, ...]:
    """Compute the vertical load on each film at running speed (`bearing_loads`: JCGM 100:2008, 5.2).

    Args:
        model: The updated model.

    Returns:
        The loads, bearing by bearing; none of a train whose coefficients do not follow from films, or without equilibrium.
    """
    films = films_over_couplings(model)
    if films is None:
        return ()
    loads = bearing_loads(films)
    return tuple(
        FilmLoad(
            bearing=bearing.id,
            vertical=float(loads.value[bearing.number, 1]),
            error=float(loads.error[bearing.number, 1]),
            area=bearing.film.diameter * bearing.film.length,
        )
        for bearing in bearings_on_films(model.machine.bearings)
    )
