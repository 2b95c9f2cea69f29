"""Journals' positions in their films and the loads on these over speed, with derivatives by the films' own parameters."""

from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats
from estimator.statics.film_model import FilmModel


@dataclass(frozen=True)
class JournalStates:
    """States of n journals at S speeds, with derivatives by the P own fitted numbers of their films.

    Attributes:
        clearance: Radial clearances (n,); infinite of a bearing that is no film [m].
        position: Positions (S, n, 2) relative to the bearings' centres, x and y [m].
        force: Forces (S, n, 2) of the films on the journals, x and y: what the bearings carry [N].
        position_slope: Derivatives (S, n, 2, P) of the positions [m].
        force_slope: Derivatives (S, n, 2, P) of the forces [N].
    """

    clearance: Floats
    position: Floats
    force: Floats
    position_slope: Floats
    force_slope: Floats


def journal_states(model: FilmModel, fitted: Floats, *, speed: Floats) -> JournalStates | None:
    """Compute where journals rest and what their films carry, between the speeds at which equilibria are solved.

    Args:
        model: The model of the films.
        fitted: Fitted numbers (P,) [-].
        speed: Spin speeds (S,), without sign; beyond the document's range states are level [rad/s].

    Returns:
        The states; None where a film is too thin.
    """
    films = model.films
    found, slopes = films.equilibria(fitted), films.sensitivity(fitted)
    if found is None or slopes is None:
        return None
    weight = model.nominal.spline(np.log(np.clip(speed, model.nominal.slowest, model.nominal.fastest)))

    def over_speed(rows: Floats) -> Floats:
        return np.tensordot(weight, rows, 1)

    def by_fitted(slopes: Floats) -> Floats:
        return model.own.by_fitted(np.moveaxis(slopes, 1, -1), speed=model.nominal.speed)

    return JournalStates(
        clearance=np.array([one.clearance for one in model.own.changed(fitted).bearings]),
        position=over_speed(np.stack([one.position for one in found])),
        force=over_speed(np.stack([one.force for one in found])),
        position_slope=over_speed(by_fitted(slopes.position)),
        force_slope=over_speed(by_fitted(slopes.force)),
    )
