"""Values of a machine document that only a slip of the unit explains; looked for where documents enter, not in stored ones."""

from collections.abc import Iterator, Mapping

from estimator.machine.document import Machine
from estimator.machine.films import JournalFilm

SMALLEST_YOUNG_MODULUS = 1e8
"""Smallest Young's modulus of a shaft [N/m²]: that of a hard rubber."""
LARGEST_IN_GIGAPASCALS = 1e4
"""Largest number that is a Young's modulus in GPa and not in MPa: a diamond has 1,200 GPa."""
LARGEST_DIAMETER = 5.0
"""Largest diameter of a shaft [m]."""
SMALLEST_STIFFNESS = 1e3
"""Smallest direct stiffness of a bearing or pedestal [N/m]: one that sinks by a millimetre under 0.1 kg."""
LARGEST_VISCOSITY = 2.0
"""Largest viscosity of an oil film [Pa s]: three times that of the thickest grade at 40 °C."""
LARGEST_ELEVATION, LARGEST_IN_MILLIMETRES = 0.01, 1.0
"""Largest elevation of a bearing over its aligned place, and largest number that is one in mm and not in µm [m]."""
SMALLEST_TOLERANCE = 1e-6
"""Smallest tolerance of a coupling's offset [m], and of its angle [rad]: what is left of none would be passed by every run."""
SLENDERNESS = (0.05, 20.0)
"""Least and largest length over diameter of a journal bearing [-]."""


def implausible_values(machine: Machine) -> Iterator[tuple[str, str]]:
    """Find values of which the unit must be another.

    Args:
        machine: The machine.

    Yields:
        The field, and the value with its unit and what is usual.
    """
    for name, material in machine.materials.items():
        if material.young_modulus < SMALLEST_YOUNG_MODULUS:
            value = material.young_modulus
            meant = "GPa" if value < LARGEST_IN_GIGAPASCALS else "MPa"
            yield f"materials.{name}.young_modulus", f"{value:g} N/m²: steel has 2.1e+11 N/m²; was {value:g} {meant} meant?"
    for i, shaft in enumerate(machine.shafts):
        for j, section in enumerate(shaft.sections):
            if section.outer_diameter > LARGEST_DIAMETER:
                message = f"{section.outer_diameter:g} m: usual is 0.01 to 2 m; was {section.outer_diameter:g} mm meant?"
                yield f"shafts[{i}].sections[{j}].outer_diameter", message
    for place in ("bearings", "pedestals"):
        for i, part in enumerate(getattr(machine, place)):
            for term in ("kxx", "kyy"):
                value = getattr(part, term)
                if value is not None and value < SMALLEST_STIFFNESS:
                    message = f"{value:g} N/m: usual is 1e+6 to 1e+10 N/m; was {value:g} N/µm meant?"
                    yield f"{place}[{i}].{term}", message
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


def _of_film(film: JournalFilm) -> Iterator[tuple[str, str]]:
    for name, value in (("diameter", film.diameter), ("length", film.length)):
        if value > LARGEST_DIAMETER:
            yield name, f"{value:g} m: usual is 0.02 to 1 m; was {value:g} mm meant?"
            return
    yield from _of_elevations({"elevation_x": film.elevation_x, "elevation_y": film.elevation_y})
    least, largest = SLENDERNESS
    if not least <= film.length / film.diameter <= largest:
        slender = f"{film.length:g} m is {film.length / film.diameter:.3g} times the diameter, {film.diameter:g} m"
        yield "length", f"{slender}: usual is 0.3 to 1.2 times, possible {least:g} to {largest:g}"
    viscosity = film.oil.viscosity
    if viscosity is not None and viscosity > LARGEST_VISCOSITY:
        yield "oil.viscosity", f"{viscosity:g} Pa s: usual is 0.005 to 0.1 Pa s; was {viscosity:g} mPa s (cP) meant?"


def _of_elevations(named: Mapping[str, float]) -> Iterator[tuple[str, str]]:
    for name, value in named.items():
        if abs(value) > LARGEST_ELEVATION:
            meant = "mm" if abs(value) <= LARGEST_IN_MILLIMETRES else "µm"
            yield name, f"{value:g} m over the aligned place: usual is up to 0.0005 m; was {value:g} {meant} meant?"
