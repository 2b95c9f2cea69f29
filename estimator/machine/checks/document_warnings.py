"""Warnings of a machine document: what is possible and taken, but probably a mistake."""

import math
from collections.abc import Iterator

from msgspec import Struct

from estimator.machine.alignment_rules import OFFSETS
from estimator.machine.checks.odd_angles import odd_angles
from estimator.machine.checks.odd_arrangements import odd_arrangements
from estimator.machine.checks.odd_forces import odd_forces
from estimator.machine.checks.odd_masses import odd_masses
from estimator.machine.checks.odd_supplies import odd_supplies
from estimator.machine.checks.rotor_masses import LEAST_DENSITY
from estimator.machine.document import Machine
from estimator.machine.films import USUAL_CLEARANCE, JournalFilm, Oil
from estimator.machine.part_coefficients import ELEMENTS, coefficient_names, nominal_value
from estimator.machine.parts import STATION_TOLERANCE, Bearing, Shaft
from estimator.usual_values import declarations

HOTTEST_FILM, HOTTEST_INLET = 120.0, 80.0
"""Temperature of a film, and of the oil that comes, above which a warning asks whether °F was meant [°C]."""
LOBED = ("elliptical", "three_lobe", "four_lobe")
"""Profiles that are round without preload."""
USUAL_SLENDERNESS = (0.2, 1.5)
"""Usual ratio of a journal bearing's length to its diameter: others are warned of [-]."""
USUAL_JOURNAL = (0.8, 1.25)
"""Usual ratio of a journal's diameter to that of its shaft there: others are warned of [-]."""
USUAL_VISCOSITY = (0.002, 0.2)
"""Usual dynamic viscosity of the oil in a film: others are warned of [Pa s]."""
LEAST_LATERAL, LEAST_ANGULAR = 1e3, 10.0
"""Lateral and angular stiffness of a coupling below which a warning asks whether the unit is right [N/m, N m/rad]."""
USUAL_TOLERANCES = {"offset": (5e-6, 1e-3, "m", "3e-05 to 0.0002"), "angle": (2e-5, 5e-3, "rad", "0.0003 to 0.0013")}
"""Least and largest tolerance of a coupling that is not warned of, its unit, and what is usual."""

SLOWEST_RANGE = 120.0
"""End of a speed range below which a warning asks whether its speeds are in Hz: hardly any train is so slow [r/min]."""

LEAST_LEFT = 0.1
"""Part of the speed range that is left above a film's valid_above_rpm below which it is warned of [-]."""
ODD = (odd_masses, odd_forces, odd_angles, odd_arrangements, odd_supplies)
"""Checks of parts that know their own fields."""


class DocumentWarning(Struct, frozen=True):
    """Something in a document that is probably a mistake.

    Attributes:
        field: Path of the field, such as `bearings[0].speed_dependence.speed_rpm`.
        words: What stands there, with its unit, and what is usual.
    """

    field: str
    words: str

    def __str__(self) -> str:
        """Return both in one line."""
        return f"{self.field}: {self.words}"


def document_warnings(machine: Machine) -> tuple[DocumentWarning, ...]:
    """List what is probably a mistake in a document that is taken.

    Args:
        machine: The machine.

    Returns:
        The warnings, in the document's order.
    """
    speeds = machine.speed_range
    of_laws = (
        DocumentWarning(f"{place}[{number}].speed_dependence.{field}", words)
        for place in ELEMENTS
        for number, part in enumerate(getattr(machine, place))
        if part.speed_dependence is not None
        for field, words in part.speed_dependence.warnings(speeds.minimum_rpm, speeds.maximum_rpm)
    )
    return (
        *_slow_speeds(machine),
        *_light_materials(machine),
        *(DocumentWarning(field, words) for found in ODD for field, words in found(machine)),
        *of_laws,
        *_incomplete_tables(machine),
        *_odd_films(machine),
        *_far_elevations(machine),
        *_far_targets(machine),
        *_odd_tolerances(machine),
        *_soft_couplings(machine),
    )


def _slow_speeds(machine: Machine) -> Iterator[DocumentWarning]:
    """Yield speeds that are probably in Hz: a slow end of the speed range, a running speed below it."""
    low, high = machine.speed_range.minimum_rpm, machine.speed_range.maximum_rpm
    if high < SLOWEST_RANGE:
        words = f"{high:g} r/min: few machines are that slow; was {high:g} Hz meant, {60 * high:g} r/min?"
        yield DocumentWarning("speed_range.maximum_rpm", words)
    running = machine.operation.running_rpm
    if running is not None and running < low:
        meant = f"; was {running:g} Hz meant, {60 * running:g} r/min?" if low <= 60 * running <= high else ""
        words = f"{running:g} r/min lies below the speed range, {low:g} to {high:g} r/min{meant}"
        yield DocumentWarning("operation.running_rpm", words)


def _far_elevations(machine: Machine) -> Iterator[DocumentWarning]:
    """Yield elevations beyond the clearance of their own bearing, whose journal would touch if the others stayed."""
    for number, bearing in enumerate(machine.bearings):
        film = bearing.film
        if film is None:
            continue
        clearance = film.radial_clearance
        for name, elevation in (("elevation_x", film.elevation_x), ("elevation_y", film.elevation_y)):
            if abs(elevation) > clearance:
                yield DocumentWarning(
                    f"bearings[{number}].film.{name}",
                    f"{_micrometres(elevation)} is more than the radial clearance, {_micrometres(clearance)}: "
                    "usual are some 10 µm; elevations are in m, over the place at which couplings carry nothing",
                )


def _far_targets(machine: Machine) -> Iterator[DocumentWarning]:
    """Yield offsets aimed at beyond the clearances: cold that may be, as pedestals grow, but not once the machine is warm."""
    widest = max((one.film.radial_clearance for one in machine.bearings if one.film is not None), default=math.inf)
    for number, target in enumerate(machine.operation.alignment_targets):
        for name, cold in target.left_cold.stated.items():
            growth = target.growth.stated.get(name, 0.0)
            warm = cold + growth
            if name in OFFSETS and abs(warm) > widest:
                grown = f", {_micrometres(warm)} with its growth," if growth else ""
                yield DocumentWarning(
                    f"operation.alignment_targets[{number}].left_cold.{name}",
                    f"{_micrometres(cold)}{grown} is more than the radial clearance, {_micrometres(widest)}: "
                    "usual are some 10 µm",
                )


def _odd_tolerances(machine: Machine) -> Iterator[DocumentWarning]:
    """Yield tolerances so tight that healthy machines pass them, or so wide that nothing is told before it breaks."""
    for number, tolerance in enumerate(machine.operation.alignment_tolerances):
        for name, (least, largest, unit, usual) in USUAL_TOLERANCES.items():
            allowed = getattr(tolerance, name)
            if allowed is None or least <= allowed <= largest:
                continue
            then = "growth from cold to hot alone passes it" if allowed < least else "no alarm would come in time"
            words = f"{allowed:g} {unit}: {then}; usual is {usual} {unit}"
            yield DocumentWarning(f"operation.alignment_tolerances[{number}].{name}", words)


def _micrometres(length: float) -> str:
    """Return a length [m] in µm, with all digits before the decimal point."""
    size = 1e6 * length
    return f"{size:.0f} µm" if abs(size) >= 1e4 else f"{size:.4g} µm"


def _light_materials(machine: Machine) -> Iterator[DocumentWarning]:
    for name, material in machine.materials.items():
        if material.density < LEAST_DENSITY:
            yield DocumentWarning(
                f"materials.{name}.density",
                f"{material.density:g} kg/m³: steel has 7850 kg/m³; was {material.density:g} g/cm³ meant?",
            )


def _incomplete_tables(machine: Machine) -> Iterator[DocumentWarning]:
    """Yield parts of which a table gives some coefficients, and nothing the others."""
    rpm = machine.speed_range.middle_rpm
    for place in ELEMENTS:
        for number, part in enumerate(getattr(machine, place)):
            names, form = coefficient_names(part), part.speed_dependence
            if form is None or all(form.nominal(name, rpm) is None for name in names):
                continue
            missing = [name for name in names if nominal_value(part, name, rpm=rpm) is None]
            if missing:
                words = f"neither in the table nor beside it: {', '.join(missing)}; each is a constant that a fit must find"
                guess = "until then a direct term is taken to be as large as its like, a cross-coupled term to be 0"
                yield DocumentWarning(f"{place}[{number}].speed_dependence", f"{words}; {guess}")


def _odd_films(machine: Machine) -> Iterator[DocumentWarning]:
    """Yield proportions of films that no maker builds, and journals that are not as thick as their shaft."""
    for number, bearing in enumerate(machine.bearings):
        if bearing.film is not None:
            shaft = _diameters(machine.shaft(bearing.shaft), bearing.station)
            for name, words in _odd_film(bearing, bearing.film, shaft):
                yield DocumentWarning(f"bearings[{number}].film.{name}", words)
            lifted, fastest = bearing.film.valid_above_rpm, machine.speed_range.maximum_rpm
            if lifted >= fastest:
                words = f"{lifted:g} r/min is not below the end of the speed range, {fastest:g} r/min: no sample would be left"
                yield DocumentWarning(f"bearings[{number}].film.valid_above_rpm", words)
            elif fastest - lifted < LEAST_LEFT * (fastest - machine.speed_range.minimum_rpm):
                words = f"{lifted:g} r/min is near the end of the speed range, {fastest:g} r/min: few samples would be left"
                yield DocumentWarning(f"bearings[{number}].film.valid_above_rpm", words)


def _odd_film(bearing: Bearing, film: JournalFilm, shaft: tuple[float, ...]) -> Iterator[tuple[str, str]]:
    """Yield fields of a film, on a shaft of these diameters [m], with what is odd about them."""
    radius = film.diameter / 2
    part = film.radial_clearance / radius
    if part < USUAL_CLEARANCE[0] or (1.0 - film.preload) * part > USUAL_CLEARANCE[1]:
        words = f"{_micrometres(film.radial_clearance)} is {part:.2g} of the radius, {radius:g} m"
        yield "radial_clearance", f"{words}: usual is 0.001 to 0.002 of it, half the difference of the diameters"
    slender = film.length / film.diameter
    if not USUAL_SLENDERNESS[0] <= slender <= USUAL_SLENDERNESS[1]:
        words = f"{film.length:g} m is {slender:.2g} times the diameter, {film.diameter:g} m"
        yield "length", f"{words}: usual is 0.3 to 1.2 times"
    if film.preload == 0.0 and film.profile in LOBED:
        yield "preload", f"profile {film.profile} without preload is a round bore: usual is 0.3 to 0.6"
    yield from _odd_oil(film.oil)
    if not any(USUAL_JOURNAL[0] <= film.diameter / one <= USUAL_JOURNAL[1] for one in shaft):
        thick = " or ".join(f"{one:g}" for one in shaft)
        words = f"{film.diameter:g} m, but shaft '{bearing.shaft}' is {thick} m thick at station {bearing.station:g} m"
        yield "diameter", f"{words}: the journal is that part of the shaft"


def _odd_oil(oil: Oil) -> Iterator[tuple[str, str]]:
    """Yield fields of a film's oil with what is odd about them."""
    if oil.viscosity is not None and not USUAL_VISCOSITY[0] <= oil.viscosity <= USUAL_VISCOSITY[1]:
        words = f"{oil.viscosity:g} Pa s: warm turbine oil has 0.005 to 0.1 Pa s, 5 to 100 mPa s (cP)"
        yield "oil.viscosity", words + declarations(Oil)["viscosity"].question(oil.viscosity)
    for name, value, hottest in (("temperature_c", oil.temperature_c, HOTTEST_FILM), ("inlet_c", oil.inlet_c, HOTTEST_INLET)):
        if value is not None and value > hottest:
            words = f"{value:g} °C: oil is hardly ever above {hottest:g} °C there"
            yield f"oil.{name}", f"{words}; was {value:g} °F meant, {(value - 32.0) / 1.8:.0f} °C?"


def _diameters(shaft: Shaft, station: float) -> tuple[float, ...]:
    """Return the outer diameters of a shaft at a station: two where two sections meet [m]."""
    begins, found = 0.0, []
    for section in shaft.sections:
        if begins - STATION_TOLERANCE <= station <= begins + section.length + STATION_TOLERANCE:
            found.append(section.outer_diameter)
        begins += section.length
    return tuple(dict.fromkeys(found))


def _soft_couplings(machine: Machine) -> Iterator[DocumentWarning]:
    for number, coupling in enumerate(machine.couplings):
        for terms, least, unit, usual, meant in (
            (("kxx", "kyy"), LEAST_LATERAL, "N/m", "1e+5 to 1e+10 N/m", "N/µm"),
            (("k_phix", "k_phiy"), LEAST_ANGULAR, "N m/rad", "1e+3 to 1e+8 N m/rad", "MN m/rad"),
        ):
            for term in terms:
                value = getattr(coupling, term)
                if value is not None and value < least:
                    words = f"{value:g} {unit}: usual is {usual}; was {value:g} {meant} meant?"
                    yield DocumentWarning(f"couplings[{number}].{term}", words)
