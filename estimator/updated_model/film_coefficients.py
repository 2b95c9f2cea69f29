"""Coefficients of a train's oil films over speed, with 95 % bands.

Standard errors to first order (JCGM 100:2008, 5.2) from the covariance of all coordinates, the films' deviations from their
model included. The rule of estimates holds at each speed: what is too uncertain has no value there.
"""

from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats
from estimator.bearings.terms import LATERAL, Term
from estimator.fit.estimates import CONFIDENCE_95, LARGEST_DIRECT_ERROR, LARGEST_RELATIVE_ERROR
from estimator.quantities import UNITS
from estimator.updated_model.film_results import placed_films
from estimator.updated_model.model import UpdatedModel
from estimator.updated_model.uncertainty import standard_errors


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
    coordinates = model.coordinates_at(speed)
    with_films = placed_films(coordinates)
    if with_films is None:
        return ()
    placed, films = with_films
    theta = coordinates.theta(model.values)
    unit = coordinates.unit[placed.numbers]
    covariance = model.covariance[np.ix_(placed.numbers, placed.numbers)] / np.outer(unit, unit)
    value, error = placed.values(theta), standard_errors(placed.derivatives(theta, slice(None)), covariance)
    column = {name: c for c, name in enumerate(films.coefficients)}
    found = []
    for bearing in model.machine.bearings:
        if bearing.film is None:
            continue
        for term in LATERAL:
            c, *beside = (column[f"bearing.{bearing.id}.{one}"] for one in (term.name, *term.beside))
            size = np.sqrt(np.abs(value[:, beside].prod(axis=1)))
            found.append(_banded(bearing.id, term, value[:, c], error[:, c], size))
    return tuple(found)


def _banded(bearing: str, term: Term, value: Floats, error: Floats, size: Floats) -> FilmCoefficient:
    """State a coefficient by the rules of estimates: a positive direct term by its logarithm, nothing too uncertain."""
    positive = term.direct & (value > 0.0)
    uncertain = error > np.where(positive, LARGEST_DIRECT_ERROR, LARGEST_RELATIVE_ERROR) * size
    half = CONFIDENCE_95 * error
    ratio = np.exp(half / np.where(positive & ~uncertain, value, np.inf))
    lower, upper = np.where(positive, value / ratio, value - half), np.where(positive, value * ratio, value + half)
    shown = (np.where(uncertain, np.nan, one) for one in (value, lower, upper))
    return FilmCoefficient(bearing, term.name, UNITS[term.quantity], *shown)
