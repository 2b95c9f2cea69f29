"""Place of a train's films among the coordinates of a fit, and the covariance of their numbers."""

import numpy as np
from numpy.typing import NDArray

from estimator.arrays import Floats
from estimator.fit.problem.coordinates import Coordinates
from estimator.fit.problem.placed_models import PlacedModel
from estimator.statics.film_model import FilmModel
from estimator.updated_model.model import UpdatedModel


def placed_films(coordinates: Coordinates) -> tuple[PlacedModel, FilmModel] | None:
    """Find the model of the films among those that a fit's coordinates belong to.

    Args:
        coordinates: Coordinates of the fit.

    Returns:
        The model with its place, and as what it is; None of a train whose coefficients do not follow from films.
    """
    return next(((one, one.model) for one in coordinates.models if isinstance(one.model, FilmModel)), None)


def covariance_among(places: NDArray[np.intp], model: UpdatedModel, coordinates: Coordinates) -> Floats:
    """Return the covariance of some of a model's coordinates.

    Args:
        places: Their places (n,).
        model: The updated model.
        coordinates: Its coordinates.

    Returns:
        Covariance (n, n) [-].
    """
    unit = coordinates.unit[places]
    return np.asarray(model.covariance[np.ix_(places, places)] / np.outer(unit, unit))
