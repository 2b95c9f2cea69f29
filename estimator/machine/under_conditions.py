"""A machine under its operating conditions: temperatures of oil and static forces follow what was measured beside the run."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

from pydantic import ValidationError

from estimator.machine.document import Machine
from estimator.machine.films import Oil, StaticLoad
from estimator.machine.parts import Bearing

FAR = 40.0
"""Largest difference of an oil's temperature from the stated one that a run may well have [K]: seasons bring 10."""
COLDER, WARMER = 35.0, 12.0
"""Largest differences [K] by which a reading converted from °F may lie below and above the stated temperature for °F to be
assumed: oil is colder than usual in winter and after a standstill."""

LEAST_FACTOR = 1e-3
"""Least spread of a force, relative to its full spread [-]: it holds where the force itself is zero."""

CACHED_MACHINES = 32
"""Number of machines under conditions in the cache: an assessment asks again and again for those of a baseline and of the
newest runs, and what is computed of each is cached by its identity."""


@dataclass(frozen=True, eq=False)
class _Asked:
    """A machine, by its identity, and the values of the conditions that something of it follows."""

    machine: Machine
    known: tuple[tuple[str, float], ...]

    def __hash__(self) -> int:
        return hash((id(self.machine), self.known))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Asked) and self.machine is other.machine and self.known == other.known


class ConditionImpossible(ValueError):
    """Raised when an operating condition has a value that no machine has."""


def under_conditions(machine: Machine, conditions: Mapping[str, float | None]) -> Machine:
    """Return a machine as it is under some operating conditions.

    Args:
        machine: The machine as its document describes it.
        conditions: Value of each operating condition [unit of the document]; None where it was not measured, which leaves
            what follows it as the document states it.

    Returns:
        The machine; the same one where nothing follows a condition that was measured.

    Raises:
        ConditionImpossible: An oil would be colder or hotter than a document may say.
    """
    followed = {one.film.oil.temperature_from for one in machine.bearings if one.film is not None}
    followed |= {one.scaled_by for one in machine.static_loads}
    known = tuple((name, value) for name, value in sorted(conditions.items()) if name in followed and value is not None)
    return _under(_Asked(machine, known)) if known else machine


@lru_cache(maxsize=CACHED_MACHINES)
def _under(asked: "_Asked") -> Machine:
    machine, known = asked.machine, dict(asked.known)
    bearings = tuple(_bearing(one, known) for one in machine.bearings)
    loads = tuple(_load(one, known) for one in machine.static_loads)
    if bearings == machine.bearings and loads == machine.static_loads:
        return machine
    return machine.model_copy(update={"bearings": bearings, "static_loads": loads})


def require_celsius(machine: Machine, conditions: Mapping[str, float | None]) -> None:
    """Check that temperatures of oil are not sent in °F: far from what the document states, and near it when they are.

    Args:
        machine: The machine as its document describes it.
        conditions: Value of each operating condition [unit of the document]; None where it was not measured.

    Raises:
        ConditionImpossible: One probably is.
    """
    for bearing in machine.bearings:
        oil = None if bearing.film is None else bearing.film.oil
        stated = None if oil is None else oil.temperature_c if oil.inlet_c is None else oil.inlet_c
        sent = None if oil is None or oil.temperature_from is None else conditions.get(oil.temperature_from)
        if oil is None or stated is None or sent is None:
            continue
        celsius = (sent - 32.0) / 1.8
        if sent - stated > FAR and -COLDER < celsius - stated < WARMER:
            raise ConditionImpossible(
                f"operating condition '{oil.temperature_from}' is {sent:.4g}, where the document states {stated:.4g} °C for "
                f"the oil of bearing {bearing.id}: were °F sent ({celsius:.0f} °C)? It must come in °C"
            )


def _bearing(bearing: Bearing, known: Mapping[str, float]) -> Bearing:
    film = bearing.film
    temperature = None if film is None or film.oil.temperature_from is None else known.get(film.oil.temperature_from)
    if film is None or temperature is None:
        return bearing
    oil = _oil(film.oil, temperature, bearing.id)
    return bearing.model_copy(update={"film": film.model_copy(update={"oil": oil})})


def _oil(oil: Oil, temperature: float, bearing: str) -> Oil:
    field = "temperature_c" if oil.inlet_c is None else "inlet_c"
    try:
        return Oil.model_validate(oil.model_dump() | {field: temperature})
    except ValidationError as error:
        raise ConditionImpossible(
            f"operating condition '{oil.temperature_from}' is {temperature:.4g} °C, from which the oil of bearing {bearing} "
            f"takes its {field}: {error.errors()[0]['msg']}"
        ) from error


def _load(load: StaticLoad, known: Mapping[str, float]) -> StaticLoad:
    value = None if load.scaled_by is None else known.get(load.scaled_by)
    if value is None or load.stated_at is None:
        return load
    factor = value / load.stated_at
    # Where nothing is left of a force it stays an unknown, of which the run says nothing.
    spreads = {name: max(abs(factor), LEAST_FACTOR) * getattr(load, name) for name in ("force_x_spread", "force_y_spread")}
    return load.model_copy(update={"force_x": factor * load.force_x, "force_y": factor * load.force_y, **spreads})
