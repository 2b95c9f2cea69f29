"""Static shear and moment that each coupling of a train on oil films carries at running speed, beside the synchronous loads.

They are what the bearings behind the coupling leave of the weight there, so that their errors come from the loads' own, with
all that these have in common (JCGM 100:2008, 5.2), and are averaged as they are (`averaged_over_couplings`).
"""

from collections.abc import Sequence

import numpy as np

from estimator.arrays import Floats
from estimator.machine.parameter_description import describe
from estimator.rotor.parameter_names import STATIC_LOAD_UNITS
from estimator.statics.coupling_balance import CouplingBalance, coupling_balances
from estimator.statics.film_model import FilmModel
from estimator.statics.journal_states import JournalStates
from estimator.updated_model.expected_at_stiffness import Prediction
from estimator.updated_model.film_results import FilmResult
from estimator.updated_model.films_over_couplings import films_over_couplings
from estimator.updated_model.model import UpdatedModel

PLANES = ("horizontal", "vertical")
"""Planes in the order of x and y."""


def static_coupling_loads(model: UpdatedModel) -> tuple[FilmResult, ...]:
    """Compute what each coupling pushes and turns its driven half with, at running speed (statics of a free body).

    Args:
        model: The updated model.

    Returns:
        Shears [N] and moments [N m], coupling by coupling; none of a train whose coefficients do not follow from films.
    """
    films = films_over_couplings(model)
    if films is None:
        return ()
    balances = coupling_balances(model.machine)
    loads = films.states.averaged(lambda fitted, states: _predicted(balances, films.model, states, fitted))
    names = [
        f"coupling.{one.coupling}.static_{what}_{plane}"
        for one in balances
        for what in ("shear", "moment")
        for plane in PLANES
    ]
    return tuple(
        FilmResult(name, STATIC_LOAD_UNITS[describe(name).quantity], value, error)
        for name, value, error in zip(names, loads.value.tolist(), loads.error.tolist(), strict=True)
    )


def _predicted(balances: Sequence[CouplingBalance], films: FilmModel, states: JournalStates, fitted: Floats) -> Prediction:
    """Return shear and moment of each coupling, horizontal and vertical, with their derivatives by the films' own numbers."""
    force, slope = states.force[-1], states.force_slope[-1]
    added, by_added = films.own.load_changes(fitted).reshape(-1, 2), films.own.by_load.reshape(-1, 2, slope.shape[-1])
    values, slopes = [np.zeros(0)], [np.zeros((0, slope.shape[-1]))]
    for one in balances:
        for given, weight, load in ((one.weight, one.carried, one.loaded), (one.moment, one.arm, one.load_arm)):
            values.append(-(given + weight @ force + load @ added))
            slopes.append(-np.tensordot(weight, slope, 1) - np.tensordot(load, by_added, 1))
    return Prediction(np.concatenate(values), np.concatenate(slopes))
