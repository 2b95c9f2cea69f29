"""Loads on a train's bearings at running speed, with their errors.

Two bearings alone carry what the shaft weighs, whatever the fit finds: beside what it leaves open, a load is known no better
than the masses of the document (JCGM 100:2008, 4.3).
"""

import numpy as np

from estimator.statics.journal_states import JournalStates
from estimator.updated_model.averaged_over_couplings import Averaged
from estimator.updated_model.expected_at_stiffness import Prediction
from estimator.updated_model.films_over_couplings import FilmsOverCouplings

WEIGHT_ERROR = 0.002
"""Part of a bearing's load by which that may be off beside what a fit leaves open, rms [-]: masses are known no better."""


def bearing_loads(films: FilmsOverCouplings) -> Averaged:
    """Compute the loads on a train's bearings at running speed (JCGM 100:2008, 4.3, and averages over open couplings).

    Args:
        films: The train's films, at the estimate and over its open couplings.

    Returns:
        Loads and their standard errors (n, 2), horizontal and vertical [N].
    """
    found = films.states.averaged(lambda _, states: _forces(states))
    load, error = found.value.reshape(-1, 2), found.error.reshape(-1, 2)
    of_masses = WEIGHT_ERROR * np.hypot(*load.T)[:, None]
    return Averaged(load, np.hypot(error, of_masses))


def _forces(states: JournalStates) -> Prediction:
    slope = states.force_slope[-1]
    return Prediction(states.force[-1].reshape(-1), slope.reshape(-1, slope.shape[-1]))
