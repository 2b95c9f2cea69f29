"""What a machine document's parts say of each other: the checks that one field alone cannot make."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING, Any

from pydantic_core import InitErrorDetails, PydanticCustomError

if TYPE_CHECKING:
    from estimator.machine import Machine

STATION_TOLERANCE = 1e-9
"""Two stations closer than this [m] are the same place."""

LATERAL = ("kxx", "kxy", "kyx", "kyy", "cxx", "cxy", "cyx", "cyy")
"""Coefficients that every bearing, coupling and seal has."""
ANGULAR = ("k_phix", "k_phiy")
"""Coefficients that every coupling has besides."""
OPTIONAL = {"couplings": ("k_phixy", "k_phiyx", "c_phix", "c_phiy", "kx_phiy", "ky_phix"), "seals": ("mxx", "myy")}
"""Coefficients that are identified only where the document gives them."""
ELEMENTS = {"bearings": "bearing", "couplings": "coupling", "seals": "seal"}
"""Lists of the document whose parts have coefficients, and what their parameters' names begin with."""


def coefficient_values(machine: Machine) -> dict[str, float | None]:
    """Nominal value by name, such as `bearing.B1.kxx`, of every coefficient that is identified."""
    return {
        f"{kind}.{part.id}.{name}": getattr(part, name)
        for place, kind in ELEMENTS.items()
        for part in getattr(machine, place)
        for name in coefficient_names(place, part)
    }


def coefficient_names(place: str, part: Any) -> tuple[str, ...]:
    """Names of the coefficients that are identified of a part in that list of the document."""
    given = tuple(name for name in OPTIONAL.get(place, ()) if getattr(part, name) is not None)
    return LATERAL + (ANGULAR if place == "couplings" else ()) + given


def planes(machine: Machine) -> dict[str, float | None]:
    """Nominal magnitude by name, such as `disc.D1.unbalance`, of every residual unbalance."""
    return {f"disc.{d.id}.unbalance": None if d.unbalance is None else d.unbalance.magnitude for d in machine.discs}


def _problem(location: tuple[int | str, ...], value: Any, message: str) -> InitErrorDetails:
    # The message goes in as context: it may hold braces of its own.
    error = PydanticCustomError("machine_document", "{message}", {"message": message})
    return InitErrorDetails(type=error, loc=location, input=value)


def reference_problems(machine: Machine) -> Iterator[InitErrorDetails]:
    yield from _material_problems(machine)
    yield from _duplicate_problems(machine)
    yield from _station_problems(machine)
    running, highest = machine.operation.running_rpm, machine.speed_range.maximum_rpm
    if running is not None and running > highest:
        message = f"lies above the speed range, which ends at {highest:g} r/min"
        yield _problem(("operation", "running_rpm"), running, message)
    yield from _coupling_problems(machine)
    yield from _dependence_problems(machine)
    yield from _rule_problems(machine)


def _material_problems(machine: Machine) -> Iterator[InitErrorDetails]:
    known = ", ".join(machine.materials)
    for i, shaft in enumerate(machine.shafts):
        for j, section in enumerate(shaft.sections):
            if section.material not in machine.materials:
                message = f"'{section.material}' is not one of the materials: {known}"
                yield _problem(("shafts", i, "sections", j, "material"), section.material, message)


def _duplicate_problems(machine: Machine) -> Iterator[InitErrorDetails]:
    for name in ("shafts", "discs", "bearings", "couplings", "seals", "probes"):
        parts = getattr(machine, name)
        counts = Counter(part.id for part in parts)
        for i, part in enumerate(parts):
            if counts[part.id] > 1:
                yield _problem((name, i, "id"), part.id, f"'{part.id}' stands more than once among the {name}")
    names = Counter(machine.condition_names)
    for i, name in enumerate(machine.condition_names):
        if names[name] > 1:
            yield _problem(("conditions", i, "name"), name, f"'{name}' stands more than once among the conditions")


def _station_problems(machine: Machine) -> Iterator[InitErrorDetails]:
    lengths = {shaft.id: shaft.length for shaft in machine.shafts}
    for name in ("discs", "bearings", "seals", "probes"):
        for i, part in enumerate(getattr(machine, name)):
            if part.shaft not in lengths:
                message = f"'{part.shaft}' is not one of the shafts: {', '.join(lengths)}"
                yield _problem((name, i, "shaft"), part.shaft, message)
            elif part.station > lengths[part.shaft] + STATION_TOLERANCE:
                message = f"{part.station} lies beyond shaft '{part.shaft}', which is {lengths[part.shaft]:.6g} m long"
                yield _problem((name, i, "station"), part.station, message)


def _coupling_problems(machine: Machine) -> Iterator[InitErrorDetails]:
    known = [shaft.id for shaft in machine.shafts]
    for i, coupling in enumerate(machine.couplings):
        for end in ("driver", "driven"):
            if getattr(coupling, end) not in known:
                message = f"'{getattr(coupling, end)}' is not one of the shafts: {', '.join(known)}"
                yield _problem(("couplings", i, end), getattr(coupling, end), message)
        if coupling.driver == coupling.driven:
            yield _problem(("couplings", i, "driven"), coupling.driven, "a coupling joins two different shafts")
    yield from _ring_problems(machine)
    for end in ("driver", "driven"):
        counts = Counter(getattr(coupling, end) for coupling in machine.couplings)
        for i, coupling in enumerate(machine.couplings):
            if counts[getattr(coupling, end)] > 1:
                message = f"shaft '{getattr(coupling, end)}' is the {end} of more than one coupling"
                yield _problem(("couplings", i, end), getattr(coupling, end), message)


def _ring_problems(machine: Machine) -> Iterator[InitErrorDetails]:
    """A train has two ends: following its couplings from driver to driven must not come back."""
    behind = {coupling.driver: coupling.driven for coupling in machine.couplings}
    for i, coupling in enumerate(machine.couplings):
        shaft: str | None = coupling.driven
        for _ in machine.couplings:
            if shaft == coupling.driver != coupling.driven:
                yield _problem(("couplings", i, "driven"), coupling.driven, "the couplings join the shafts to a ring")
                break
            shaft = behind.get(shaft) if shaft is not None else None


def _dependence_problems(machine: Machine) -> Iterator[InitErrorDetails]:
    for place in ELEMENTS:
        for i, part in enumerate(getattr(machine, place)):
            dependence = part.speed_dependence
            known = coefficient_names(place, part)
            for name in (dependence and dependence.coefficients) or ():
                if name not in known:
                    message = f"'{name}' is not identified here; what is: {', '.join(known)}"
                    yield _problem((place, i, "speed_dependence", "coefficients"), name, message)


def _rule_problems(machine: Machine) -> Iterator[InitErrorDetails]:
    coefficients = coefficient_values(machine)
    values = coefficients | planes(machine)
    in_force = {name: i for i, rule in enumerate(machine.parameters) for name in values if fnmatchcase(name, rule.names)}
    for i, rule in enumerate(machine.parameters):
        if not any(fnmatchcase(name, rule.names) for name in values):
            message = f"'{rule.names}' matches no parameter; one of them is {next(iter(values))}"
            yield _problem(("parameters", i, "names"), rule.names, message)
        ruled = [name for name in values if in_force.get(name) == i]
        unknown = [name for name in ruled if values[name] is None]
        if unknown and rule.tied_to is None:
            message = f"needs a nominal value of {', '.join(unknown)}"
            yield _problem(("parameters", i), rule.names, message)
        nothing = [name for name in ruled if name not in coefficients and values[name] == 0.0]
        if nothing and rule.spread is not None:
            message = f"a part of {', '.join(nothing)} is no spread: its nominal magnitude is zero"
            yield _problem(("parameters", i), rule.names, message)
    tied = {name: i for name, i in in_force.items() if machine.parameters[i].tied_to is not None}
    yield from _tie_problems(machine, coefficients, tied)


def _tie_problems(machine: Machine, coefficients: dict[str, float | None], tied: dict[str, int]) -> Iterator[InitErrorDetails]:
    """tied: by name of a tied parameter, the rule that ties it."""
    for name, i in tied.items():
        target = machine.parameters[i].tied_to
        leader = f"{target}.{name.rsplit('.', 1)[-1]}"
        if leader == name:
            message = f"'{name}' cannot be tied to itself"
        elif leader not in coefficients or name not in coefficients:
            message = f"'{name}' cannot be tied to '{leader}': both must be coefficients of bearings, couplings or seals"
        elif leader in tied:
            message = f"'{leader}' is itself tied: tie to an element that stands on its own"
        else:
            continue
        yield _problem(("parameters", i, "tied_to"), target, message)
