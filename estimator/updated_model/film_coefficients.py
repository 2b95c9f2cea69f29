"""Coefficients of a train's oil films over speed, with 95 % bands.

Standard errors to first order (JCGM 100:2008, 5.2) from the covariance of all coordinates, the films' deviations from their
model included. The rule of estimates holds at each speed: what is too uncertain has no value there.
"""

from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats
from estimator.fit.estimates import CONFIDENCE_95, LARGEST_DIRECT_ERROR, LARGEST_RELATIVE_ERROR
from estimator.quantities import UNITS
from estimator.updated_model.film_results import UncertainCoefficient, uncertain_coefficients
from estimator.updated_model.model import UpdatedModel


@dataclass(frozen=True)
class FilmCoefficient:
    """One coefficient of one film at S speeds; NaN where the data leave it too uncertain.

    Attributes:
        bearing: Id of the bearing.
        term: Name of the term, such as `kxx`.
        unit: SI unit.
        value: Values (S,) [unit].
        lower: Lower 95 % bounds (S,) [unit].
        upper: Upper 95 % bounds (S,) [unit].
    """

    bearing: str
    term: str
    unit: str
    value: Floats
    lower: Floats
    upper: Floats


def film_coefficients(model: UpdatedModel, *, speed: Floats) -> tuple[FilmCoefficient, ...]:
    """Compute the coefficients of all films over speed (JCGM 100:2008, 5.2).

    Args:
        model: The updated model.
        speed: Speeds (S,) [rad/s], positive.

    Returns:
        The coefficients, film by film; none of a train whose coefficients do not follow from films.
    """
    return tuple(map(_banded, uncertain_coefficients(model, speed=speed)))


def _banded(one: UncertainCoefficient) -> FilmCoefficient:
    """State a coefficient by the rules of estimates: a positive direct term by its logarithm, nothing too uncertain."""
    uncertain = one.error > np.where(one.positive, LARGEST_DIRECT_ERROR, LARGEST_RELATIVE_ERROR) * one.size
    half = CONFIDENCE_95 * one.error
    ratio = np.exp(half / np.where(one.positive & ~uncertain, one.value, np.inf))
    lower = np.where(one.positive, one.value / ratio, one.value - half)
    upper = np.where(one.positive, one.value * ratio, one.value + half)
    shown = (np.where(uncertain, np.nan, column) for column in (one.value, lower, upper))
    return FilmCoefficient(one.bearing, one.term.name, UNITS[one.term.quantity], *shown)
