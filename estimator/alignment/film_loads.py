"""Static loads on the oil films of a train at running speed, with their errors, as a part of what a bearing may carry.

Highest specific pressure: white metal of lead or tin, ISO 7902-3:2020, 5 MPa.
"""

from dataclasses import dataclass

import numpy as np

from estimator.machine.bearings_on_films import bearings_on_films
from estimator.machine.film_speeds import reported_rpm
from estimator.statics.journal_states import journal_states
from estimator.units import rpm_to_rad_per_s
from estimator.updated_model.bearing_loads import bearing_loads
from estimator.updated_model.film_results import covariance_of, placed_films
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
    speed = np.array([rpm_to_rad_per_s(reported_rpm(model.machine)[-1])])
    coordinates = model.coordinates_at(speed)
    found = placed_films(coordinates)
    if found is None:
        return ()
    placed, films = found
    fitted = placed.own(coordinates.theta(model.values))
    states = journal_states(films, fitted, speed=speed)
    if states is None:
        return ()
    count = films.own.count
    covariance = covariance_of(placed, model, coordinates)[:count, :count]
    loads = bearing_loads(films, states, fitted=fitted, speed=speed, covariance=covariance)
    return tuple(
        FilmLoad(
            bearing=bearing.id,
            vertical=float(loads.value[bearing.number, 1]),
            error=float(loads.error[bearing.number, 1]),
            area=bearing.film.diameter * bearing.film.length,
        )
        for bearing in bearings_on_films(model.machine.bearings)
    )
