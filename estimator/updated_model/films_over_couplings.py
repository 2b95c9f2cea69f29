"""Films of an updated model at running speed, at its estimate and over the stiffness of couplings that it leaves open.

Loads on bearings, what couplings carry and what is told of films all follow from these states, which are sought once.
"""

from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats
from estimator.fit.problem.coordinates import Coordinates
from estimator.fit.problem.placed_models import PlacedModel
from estimator.machine.bearings_on_films import bearings_on_films
from estimator.machine.film_speeds import reported_rpm
from estimator.rotor.identity_cache import cached_by_identity
from estimator.statics.film_model import FilmModel
from estimator.statics.journal_states import JournalStates, journal_states
from estimator.units import rpm_to_rad_per_s
from estimator.updated_model.averaged_over_couplings import OverCouplings, over_couplings
from estimator.updated_model.expected_at_stiffness import FittedNumbers, Prediction
from estimator.updated_model.model import UpdatedModel
from estimator.updated_model.placed_films import covariance_among, placed_films


@dataclass(frozen=True)
class FilmsOverCouplings:
    """Films of a train at running speed.

    Attributes:
        model: The model of the films.
        states: States of the journals, at the estimate and over open couplings.
    """

    model: FilmModel
    states: OverCouplings[JournalStates]

    @property
    def covariance(self) -> Floats:
        """Return the covariance (P, P) of the films' own numbers [-]."""
        return self.states.fitted.covariance


@cached_by_identity
def films_at_estimate(model: UpdatedModel) -> FilmsOverCouplings | None:
    """Find the states of a train's films at running speed at the estimate alone; those of the last models are remembered.

    Source: standard result: of a Gaussian prior's covariance, the part of some numbers is theirs whatever the others are
    (Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, sec. A.2).

    Args:
        model: The updated model.

    Returns:
        The films, as if no coupling were open; None of a train whose coefficients do not follow from films, or without
        equilibrium.
    """
    coordinates = model.coordinates_at(_running_speed(model))
    found = placed_films(coordinates)
    if found is None:
        return None
    placed, films = found
    fitted = _fitted(model, coordinates, placed, films)
    central = journal_states(films, fitted.values, speed=_running_speed(model))
    return None if central is None else FilmsOverCouplings(films, OverCouplings(fitted, central, ()))


@cached_by_identity
def films_over_couplings(model: UpdatedModel) -> FilmsOverCouplings | None:
    """Find the states of a train's films at running speed; those of the last models are remembered (`over_couplings`).

    Source: Gauss-Hermite rule of Abramowitz and Stegun, Handbook of Mathematical Functions, 1964, 25.4.46.

    Args:
        model: The updated model.

    Returns:
        The films; None of a train whose coefficients do not follow from films, or without equilibrium.
    """
    estimate = films_at_estimate(model)
    if estimate is None:
        return None
    on_films = [one.number for one in bearings_on_films(model.machine.bearings)]

    def seen(states: JournalStates) -> Prediction:
        slope = states.force_slope[-1, on_films]
        return Prediction(states.force[-1, on_films].reshape(-1), slope.reshape(-1, slope.shape[-1]))

    def reach(values: Floats) -> JournalStates | None:
        return journal_states(estimate.model, values, speed=_running_speed(model))

    fitted, central = estimate.states.fitted, estimate.states.central
    return FilmsOverCouplings(estimate.model, over_couplings(fitted, central, reach=reach, seen=seen))


def _running_speed(model: UpdatedModel) -> Floats:
    """Return the speed (1,) at which loads are told [rad/s]."""
    return np.array([rpm_to_rad_per_s(reported_rpm(model.machine)[-1])])


def _fitted(model: UpdatedModel, coordinates: Coordinates, placed: PlacedModel, films: FilmModel) -> FittedNumbers:
    """Return what the model knows of the films' own numbers, with their prior whatever the others are."""
    theta, own = coordinates.theta(model.values), placed.numbers[: films.own.count]
    alone = np.linalg.inv(np.linalg.inv(coordinates.prior.precision)[np.ix_(own, own)])
    return FittedNumbers(
        names=[one.name for one in films.own.parameters],
        values=placed.own(theta),
        covariance=covariance_among(own, model, coordinates),
        prior=np.asarray(alone),
        pull=np.asarray(alone @ (theta - coordinates.prior.centre)[own]),
    )
