"""Results about a train's oil films: their coefficients at some speeds, loads and journals' positions.

Standard errors to first order (JCGM 100:2008, 5.2) from the covariance of all coordinates: those of coefficients hold the
films' deviations from their model. Loads are averaged over couplings that are open (`averaged_over_couplings`).
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from estimator.arrays import Bools, Floats
from estimator.bearings.terms import LATERAL, Term
from estimator.machine.bearings_on_films import bearings_on_films
from estimator.machine.film_speeds import reported_rpm
from estimator.machine.parameter_description import describe
from estimator.quantities import UNITS
from estimator.statics.journal_states import JournalStates
from estimator.units import rpm_to_rad_per_s
from estimator.updated_model.bearing_loads import bearing_loads
from estimator.updated_model.films_over_couplings import films_over_couplings
from estimator.updated_model.model import UpdatedModel
from estimator.updated_model.placed_films import covariance_among, placed_films
from estimator.updated_model.uncertainty import standard_errors


@dataclass(frozen=True)
class FilmResult:
    """One number about a film.

    Attributes:
        name: Name, such as `bearing.B1.kxx@1500rpm`.
        unit: SI unit.
        value: Value [unit].
        error: Its standard error [unit].
        size: What the error of a coefficient is compared with, the direct terms beside it [unit]; None of anything else.
        positive: Whether it is positive by nature.
    """

    name: str
    unit: str
    value: float
    error: float
    size: float | None = None
    positive: bool = False


def film_results(model: UpdatedModel) -> tuple[FilmResult, ...]:
    """Compute coefficients of all films at the speeds that the document is asked at, and states at running speed.

    Of a bearing beside them that is no film the load is told.

    Args:
        model: The updated model.

    Returns:
        The numbers, bearing by bearing; none of a train whose coefficients do not follow from films.
    """
    films = films_over_couplings(model)
    if films is None:
        return ()
    states = films.states.central
    on_films = {one.number for one in bearings_on_films(model.machine.bearings)}
    loads = bearing_loads(films)
    found = list(_coefficients(model))
    for number, bearing in enumerate(model.machine.bearings):
        for axis, name in ((1, "load_vertical"), (0, "load_horizontal")):
            load, error = float(loads.value[number, axis]), float(loads.error[number, axis])
            found.append(FilmResult(f"bearing.{bearing.id}.{name}", UNITS["force"], load, error))
        if number in on_films:
            clearance = films.model.own.place(number, "clearance")
            found += _journal(f"bearing.{bearing.id}", states, number, clearance, films.covariance)
    order = {f"bearing.{one.id}": number for number, one in enumerate(model.machine.bearings)}
    return tuple(sorted(found, key=lambda one: order[describe(one.name).element]))


@dataclass(frozen=True)
class UncertainCoefficient:
    """One coefficient of one film at S speeds.

    Attributes:
        bearing: Id of the bearing.
        term: The term.
        value: Values (S,) [SI unit].
        error: Their standard errors (S,) [SI unit].
        size: What the errors are compared with, the direct terms beside it (S,) [SI unit].
    """

    bearing: str
    term: Term
    value: Floats
    error: Floats
    size: Floats

    @property
    def positive(self) -> Bools:
        """Return where it is positive by nature (S,)."""
        return np.asarray(self.term.direct & (self.value > 0.0))


def uncertain_coefficients(model: UpdatedModel, *, speed: Floats) -> Iterator[UncertainCoefficient]:
    """Yield each coefficient over speed, film by film (JCGM 100:2008, 5.2).

    Args:
        model: The updated model.
        speed: Speeds (S,) [rad/s], positive.

    Yields:
        The coefficients; none of a train whose coefficients do not follow from films.
    """
    coordinates = model.coordinates_at(speed)
    with_films = placed_films(coordinates)
    if with_films is None:
        return
    placed, films = with_films
    theta = coordinates.theta(model.values)
    value = placed.values(theta)
    error = standard_errors(placed.derivatives(theta, slice(None)), covariance_among(placed.numbers, model, coordinates))
    column = {name: c for c, name in enumerate(films.coefficients)}
    for bearing in bearings_on_films(model.machine.bearings):
        for term in LATERAL:
            c, *beside = (column[f"bearing.{bearing.id}.{one}"] for one in (term.name, *term.beside))
            size = np.sqrt(np.abs(value[:, beside].prod(axis=1)))
            yield UncertainCoefficient(bearing.id, term, value[:, c], error[:, c], size)


def _coefficients(model: UpdatedModel) -> Iterator[FilmResult]:
    """Yield each term at each reported speed, film by film."""
    rpm = reported_rpm(model.machine)
    for one in uncertain_coefficients(model, speed=np.array([rpm_to_rad_per_s(at) for at in rpm])):
        rows = zip(rpm, one.value.tolist(), one.error.tolist(), one.size.tolist(), one.positive.tolist(), strict=True)
        for at, value, error, size, positive in rows:
            name = f"bearing.{one.bearing}.{one.term.name}@{at:g}rpm"
            yield FilmResult(name, UNITS[one.term.quantity], value, error, size, positive)


def _journal(element: str, states: JournalStates, number: int, clearance: int, covariance: Floats) -> Iterator[FilmResult]:
    """Yield position and eccentricity of one journal in its film at the last speed; clearance: place of its own among the
    parameters."""
    position, position_slope = states.position[-1, number], states.position_slope[-1, number]
    rows = [
        ("journal_x", "m", position[0], position_slope[0]),
        ("journal_y", "m", position[1], position_slope[1]),
    ]
    way = float(np.hypot(*position))
    if way > 0.0:
        part = way / states.clearance[number]
        slope = part * (position @ position_slope) / way**2
        slope[clearance] -= part  # by the logarithm of its own clearance
        rows.append(("eccentricity_ratio", "1", part, slope))
    for name, unit, value, slope in rows:
        yield FilmResult(f"{element}.{name}", unit, float(value), float(standard_errors(slope, covariance)))
