"""Values of a machine document that only a slip explains, mostly one of the unit.

They are looked for where documents enter, not in stored ones.
"""

from collections.abc import Iterator, Mapping
from fnmatch import fnmatchcase
from typing import Any

from pydantic import BaseModel

from estimator.bearings.table_columns import SMALLEST_STIFFNESS
from estimator.machine.checks.rotor_masses import LEAST_DENSITY
from estimator.machine.document import Machine, field_path
from estimator.machine.films import DEFAULT_GROOVE, Elevation, JournalFilm
from estimator.machine.parameter_description import is_direct
from estimator.machine.part_coefficients import coefficient_values
from estimator.machine.parts import Bearing, Coupling, Disc, Half, Material, Pedestal, Section
from estimator.machine.rules import ParameterRule
from estimator.usual_values import declarations, question

SMALLEST_YOUNG_MODULUS = 1e8
"""Smallest Young's modulus of a shaft [N/m²]: that of a hard rubber."""
LARGEST_SPREAD = 5.0
"""Largest spread of a direct term's logarithm [-]: a factor of 150 either way."""
LARGEST_DIAMETER = 5.0
"""Largest diameter of a shaft [m]."""
LARGEST_VISCOSITY = 2.0
"""Largest viscosity of an oil film [Pa s]: three times that of the thickest grade at 40 °C."""
LARGEST_ELEVATION = 0.01
"""Largest elevation of a bearing over its aligned place [m]."""
SMALLEST_TOLERANCE = 1e-6
"""Smallest tolerance of a coupling's offset [m], and of its angle [rad]: what is left of none would be passed by every run."""
LARGEST_POLAR = 2.02
"""Largest polar over diametral moment of inertia [-]: 2 of a flat disc, 2 % for rounded figures. No body has more."""
SLENDERNESS = (0.05, 20.0)
"""Least and largest length over diameter of a journal bearing [-]."""
TIMES_USUAL = 10.0
"""Times that a length may be the largest usual one, if it is one in another unit [-]."""


def implausible_values(machine: Machine) -> Iterator[tuple[str, str]]:
    """Find values of which the unit must be another, or that contradict their part.

    Args:
        machine: The machine.

    Yields:
        The field, and the value with its unit and what is usual.
    """
    said = dict(_by_field(machine))
    yield from said.items()
    yield from ((field, words) for field, words in _long(machine, ()) if field not in said)


def _by_field(machine: Machine) -> Iterator[tuple[str, str]]:
    """Yield fields that have bounds of their own."""
    modulus, density = declarations(Material)["young_modulus"], declarations(Material)["density"]
    diameter = declarations(Section)["outer_diameter"]
    for name, material in machine.materials.items():
        value = material.young_modulus
        if value < SMALLEST_YOUNG_MODULUS:
            yield f"materials.{name}.young_modulus", f"{value:g} N/m²: steel has 2.1e+11 N/m²{modulus.question(value)}"
        meant = density.question(material.density) if material.density < LEAST_DENSITY else ""
        if meant:
            yield f"materials.{name}.density", f"{material.density:g} kg/m³: steel has 7850 kg/m³{meant}"
    for i, shaft in enumerate(machine.shafts):
        for j, section in enumerate(shaft.sections):
            if section.outer_diameter > LARGEST_DIAMETER:
                yield f"shafts[{i}].sections[{j}].outer_diameter", diameter.words(section.outer_diameter)
    yield from _inertias(machine)
    for place in ("bearings", "pedestals"):
        for i, part in enumerate(getattr(machine, place)):
            yield from ((f"{place}[{i}].{field}", words) for field, words in _soft(part))
    for i, coupling in enumerate(machine.couplings):
        yield from ((f"couplings[{i}].{field}", words) for field, words in _soft_coupling(coupling))
    yield from _wide_rules(machine)
    for i, bearing in enumerate(machine.bearings):
        if bearing.film is not None:
            yield from ((f"bearings[{i}].film.{field}", message) for field, message in _of_film(bearing.film))
        if bearing.elevation is not None:
            named = {"x": bearing.elevation.x, "y": bearing.elevation.y}
            yield from ((f"bearings[{i}].elevation.{field}", message) for field, message in _of_elevations(named))
    for i, tolerance in enumerate(machine.operation.alignment_tolerances):
        for name, unit, usual in (("offset", "m", "3e-05 to 0.0002"), ("angle", "rad", "0.0003 to 0.0013")):
            allowed = getattr(tolerance, name)
            if allowed is not None and allowed < SMALLEST_TOLERANCE:
                message = f"{allowed:g} {unit}: no coupling stays aligned within less than 1 µ{unit}; usual is {usual} {unit}"
                yield f"operation.alignment_tolerances[{i}].{name}", message


def _inertias(machine: Machine) -> Iterator[tuple[str, str]]:
    """Yield polar moments of inertia that no body with the diametral one beside it has; 0 is one that is left out."""
    parts: list[tuple[str, Disc | Half]] = [(f"discs[{i}]", disc) for i, disc in enumerate(machine.discs)]
    for i, one in enumerate(machine.couplings):
        halves = (("driver_half", one.driver_half), ("driven_half", one.driven_half))
        parts += [(f"couplings[{i}].{name}", half) for name, half in halves if half is not None]
    for place, part in parts:
        polar, diametral = part.polar_inertia, part.diametral_inertia
        if polar > LARGEST_POLAR * diametral > 0.0:
            meant = question(polar, "kg m²", (diametral, 2.0 * diametral))
            words = f"{polar:g} kg m² is more than twice diametral_inertia, {diametral:g} kg m²: no body has that{meant}"
            yield f"{place}.polar_inertia", words


def _soft(part: Bearing | Pedestal) -> Iterator[tuple[str, str]]:
    """Yield the direct stiffnesses of a bearing or pedestal, also those of its table, that are none in N/m."""
    for term in ("kxx", "kyy"):
        value = getattr(part, term)
        if value is not None and value < SMALLEST_STIFFNESS:
            yield term, declarations(type(part))[term].words(value)
    form = part.speed_dependence
    if form is not None:
        yield from ((f"speed_dependence.{field}", words) for field, words in form.implausible())


def _soft_coupling(coupling: Coupling) -> Iterator[tuple[str, str]]:
    """Yield the direct stiffnesses of a coupling that are usual in N/µm; one near zero may stand for none."""
    for term in ("kxx", "kyy"):
        value, told = getattr(coupling, term), declarations(Coupling)[term]
        if value is not None and value < SMALLEST_STIFFNESS and told.question(value):
            yield term, told.words(value)


def _wide_rules(machine: Machine) -> Iterator[tuple[str, str]]:
    """Yield spreads of rules for direct terms that are usual in %: they count as that of the logarithm."""
    told, direct = declarations(ParameterRule)["spread"], [one for one in coefficient_values(machine) if is_direct(one)]
    for i, rule in enumerate(machine.parameters):
        if rule.spread is not None and rule.spread > LARGEST_SPREAD and any(fnmatchcase(one, rule.names) for one in direct):
            yield f"parameters[{i}].spread", told.words(rule.spread)


def _of_film(film: JournalFilm) -> Iterator[tuple[str, str]]:
    for name, value in (("diameter", film.diameter), ("length", film.length)):
        if value > LARGEST_DIAMETER:
            yield name, declarations(JournalFilm)[name].words(value)
            return
    yield from _of_elevations({"elevation_x": film.elevation_x, "elevation_y": film.elevation_y})
    least, largest = SLENDERNESS
    if not least <= film.length / film.diameter <= largest:
        slender = f"{film.length:g} m is {film.length / film.diameter:.3g} times the diameter, {film.diameter:g} m"
        yield "length", f"{slender}: usual is 0.3 to 1.2 times, possible {least:g} to {largest:g}"
    viscosity = film.oil.viscosity
    if viscosity is not None and viscosity > LARGEST_VISCOSITY:
        yield "oil.viscosity", declarations(type(film.oil))["viscosity"].words(viscosity)
    if film.profile in ("plain", "tilting_pad") and film.groove_deg != DEFAULT_GROOVE:
        words = f"{film.groove_deg:g} °: grooves go with profile two_axial_grooves or a lobed one, not with {film.profile}"
        yield "groove_deg", words


def _of_elevations(named: Mapping[str, float]) -> Iterator[tuple[str, str]]:
    for name, value in named.items():
        if abs(value) > LARGEST_ELEVATION:
            meant = declarations(Elevation)["x"].question(value)
            yield name, f"{value:g} m over the aligned place: usual is up to 0.0005 m{meant}"


def _long(part: Any, place: tuple[int | str, ...]) -> Iterator[tuple[str, str]]:
    """Yield lengths anywhere in a part that are far beyond what is usual of their field, and usual in mm or µm."""
    if isinstance(part, BaseModel):
        told = declarations(type(part))
        for name, value in part:
            own = told[name]
            if not isinstance(value, float):
                yield from _long(value, (*place, name))
            elif own.unit == "m" and own.usual is not None and value > TIMES_USUAL * own.usual[1] and own.question(value):
                yield field_path((*place, name)), own.words(value)
    elif isinstance(part, Mapping):
        for name, value in part.items():
            yield from _long(value, (*place, name))
    elif isinstance(part, tuple):
        for number, value in enumerate(part):
            yield from _long(value, (*place, number))
