"""Static shear and moment that each coupling of a train on oil films carries at running speed, beside the synchronous loads.

They are what the bearings behind the coupling leave of the weight there, so that their errors come from the loads' own, with
all that these have in common (JCGM 100:2008, 5.2).
"""

import numpy as np

from estimator.machine.film_speeds import reported_rpm
from estimator.machine.parameter_description import describe
from estimator.rotor.parameter_names import STATIC_LOAD_UNITS
from estimator.statics.coupling_balance import coupling_balances
from estimator.statics.journal_states import journal_states
from estimator.units import rpm_to_rad_per_s
from estimator.updated_model.film_results import FilmResult, placed_films
from estimator.updated_model.model import UpdatedModel
from estimator.updated_model.uncertainty import standard_errors

PLANES = ("horizontal", "vertical")
"""Planes in the order of x and y."""


def static_coupling_loads(model: UpdatedModel) -> tuple[FilmResult, ...]:
    """Compute what each coupling pushes and turns its driven half with, at running speed (statics of a free body).

    Args:
        model: The updated model.

    Returns:
        Shears [N] and moments [N m], coupling by coupling; none of a train whose coefficients do not follow from films.
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
    force, slope = states.force[-1], states.force_slope[-1]
    own = placed.numbers[: slope.shape[-1]]
    covariance = model.covariance[np.ix_(own, own)] / np.outer(coordinates.unit[own], coordinates.unit[own])
    added, by_added = films.own.load_changes(fitted).reshape(-1, 2), films.own.by_load.reshape(-1, 2, slope.shape[-1])
    results = {}
    for one in coupling_balances(model.machine):
        for what, given, weight, load in (
            ("shear", one.weight, one.carried, one.loaded),
            ("moment", one.moment, one.arm, one.load_arm),
        ):
            value = -(given + weight @ force + load @ added)
            by_own = -np.tensordot(weight, slope, 1) - np.tensordot(load, by_added, 1)
            for place, plane in enumerate(PLANES):
                results[f"coupling.{one.coupling}.static_{what}_{plane}"] = float(value[place]), by_own[place]
    return tuple(
        FilmResult(name, STATIC_LOAD_UNITS[describe(name).quantity], value, float(standard_errors(by_own, covariance)))
        for name, (value, by_own) in results.items()
    )
