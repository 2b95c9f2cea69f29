"""Loads on a train's bearings at one speed, with their errors.

Two bearings alone carry what the shaft weighs, whatever the fit finds: beside what it leaves open, a load is known no better
than the masses of the document (JCGM 100:2008, 4.3).
"""

import numpy as np

from estimator.arrays import Floats
from estimator.statics.film_model import FilmModel
from estimator.statics.journal_states import JournalStates, journal_states
from estimator.updated_model.averaged_over_couplings import Averaged, Prediction, averaged_over_couplings

WEIGHT_ERROR = 0.002
"""Part of a bearing's load by which that may be off beside what a fit leaves open, rms [-]: masses are known no better."""


def bearing_loads(films: FilmModel, states: JournalStates, *, fitted: Floats, speed: Floats, covariance: Floats) -> Averaged:
    """Compute the loads on a train's bearings at the last speed (JCGM 100:2008, 4.3, and averages over open couplings).

    Args:
        films: Model of the train's films.
        states: States of the n journals at the estimate.
        fitted: The estimate, fitted numbers of the films (P,) first [-].
        speed: Speeds (S,) of the states [rad/s].
        covariance: Covariance (P, P) of the films' own numbers [-].

    Returns:
        Loads and their standard errors (n, 2), horizontal and vertical [N].
    """

    def at(other: Floats) -> Prediction | None:
        found = journal_states(films, other, speed=speed)
        return None if found is None else _forces(found)

    names = [one.name for one in films.own.parameters]
    found = averaged_over_couplings(at, _forces(states), names=names, fitted=fitted, covariance=covariance)
    load, error = found.value.reshape(-1, 2), found.error.reshape(-1, 2)
    of_masses = WEIGHT_ERROR * np.hypot(*load.T)[:, None]
    return Averaged(load, np.hypot(error, of_masses))


def _forces(states: JournalStates) -> Prediction:
    slope = states.force_slope[-1]
    return Prediction(states.force[-1].reshape(-1), slope.reshape(-1, slope.shape[-1]))
