"""Static loads on the oil films of a train at running speed, with their errors, as a part of what a bearing may carry.

Highest specific pressure: white metal of lead or tin, ISO 7902-3:2020, 5 MPa.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache

from estimator.machine.bearings_on_films import bearings_on_films
from estimator.updated_model.averaged_over_couplings import Averaged
from estimator.updated_model.bearing_loads import bearing_loads
from estimator.updated_model.films_over_couplings import films_at_estimate, films_over_couplings
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


@dataclass(frozen=True)
class FilmLoads:
    """Loads on a train's films that are computed when they are asked for.

    Attributes:
        first_order: Function that computes them to first order at the fit's estimate, in a tenth of the time.
        known: Function that computes them over the stiffness of couplings that the fit leaves open.
    """

    first_order: Callable[[], Sequence[FilmLoad]]
    known: Callable[[], Sequence[FilmLoad]]

    @classmethod
    def of(cls, model: Callable[[], UpdatedModel]) -> "FilmLoads":
        """Return the loads of a model.

        Source: as `bearing_loads`: JCGM 100:2008, 5.2.

        Args:
            model: Function that returns the updated model.

        Returns:
            The loads, each computed once.
        """
        return cls(cache(lambda: _first_order_loads(model())), cache(lambda: film_loads(model())))


def film_loads(model: UpdatedModel) -> tuple[FilmLoad, ...]:
    """Compute the vertical load on each film at running speed (`bearing_loads`: JCGM 100:2008, 5.2).

    Args:
        model: The updated model.

    Returns:
        The loads, bearing by bearing; none of a train whose coefficients do not follow from films, or without equilibrium.
    """
    films = films_over_couplings(model)
    return () if films is None else _of_bearings(model, bearing_loads(films))


def _first_order_loads(model: UpdatedModel) -> tuple[FilmLoad, ...]:
    films = films_at_estimate(model)
    return () if films is None else _of_bearings(model, bearing_loads(films))


def _of_bearings(model: UpdatedModel, loads: Averaged) -> tuple[FilmLoad, ...]:
    return tuple(
        FilmLoad(
            bearing=bearing.id,
            vertical=float(loads.value[bearing.number, 1]),
            error=float(loads.error[bearing.number, 1]),
            area=bearing.film.diameter * bearing.film.length,
        )
        for bearing in bearings_on_films(model.machine.bearings)
    )
