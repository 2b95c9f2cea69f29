"""Response of the updated model at any place of any shaft, not only at the probes: seals, couplings, discs.

Between two nodes the shaft bends as its element does, by the shape functions of the Timoshenko beam (Friedman & Kosmatka,
Comput. Struct. 47 (1993) 473, doi:10.1016/0045-7949(93)90243-7). A node more would change the mesh with which the unknowns
were identified: on the coarse mesh of the thesis's Chapter 3 by up to 0.5 % of the response, more than its uncertainty.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats
from estimator.machine.document import Machine
from estimator.machine.parts import STATION_TOLERANCE, Probe, Section
from estimator.rotor.assembly import Rotor, assemble_rotor
from estimator.rotor.shaft_element import NODE_DOFS, shear_coefficient
from estimator.updated_model.forced_response import forced_response
from estimator.updated_model.model import UpdatedModel
from estimator.updated_model.uncertainty import PhasorBand


@dataclass(frozen=True)
class StationResponse:
    """Displacement at n places and S speeds.

    Attributes:
        speed: Speeds (S,) [rad/s].
        places: The n places.
        response: 1× phasors (S, n), 0-to-peak [m], with 95 % bands.
    """

    speed: Floats
    places: tuple[Probe, ...]
    response: PhasorBand


def station_response(model: UpdatedModel, *, speed: Floats, places: Sequence[Probe]) -> StationResponse:
    """Compute the response of a machine to its identified excitations, in its sense of rotation.

    Args:
        model: The updated model.
        speed: Speeds (S,), positive [rad/s].
        places: Places, as probes would sit there; the machine's own are places like any other.

    Returns:
        The response.

    Raises:
        ValueError: A place is not on a shaft, or a speed is not positive.
    """
    rotor = assemble_rotor(model.machine)
    rows = np.array([displacement_row(model.machine, rotor, place) for place in places]).reshape(-1, rotor.size)
    band = forced_response(model, speed=speed, output=rows).band(model)
    return StationResponse(speed=np.asarray(speed), places=tuple(places), response=band)


def displacement_row(machine: Machine, rotor: Rotor, place: Probe) -> Floats:
    """Compute the row that gives the displacement along a place's angle from all degrees of freedom.

    Source: Friedman & Kosmatka (1993, doi:10.1016/0045-7949(93)90243-7).

    Args:
        machine: The machine.
        rotor: Its assembled rotor.
        place: The place.

    Returns:
        Row (N,) [-, m].

    Raises:
        ValueError: The place is not on a shaft.
    """
    _require_on_shaft(machine, place)
    stations = rotor.stations[place.shaft]
    element = min(int(np.searchsorted(stations, place.station, side="right")) - 1, stations.size - 2)
    start, stop = float(stations[element]), float(stations[element + 1])
    at_first, tilt_first, at_second, tilt_second = _shape_functions(
        part=min((place.station - start) / (stop - start), 1.0),
        length=stop - start,
        shear=_shear_parameter(machine, _section_at(machine, place.shaft, (start + stop) / 2), stop - start),
    )
    angle = math.radians(place.angle_deg)
    x = NODE_DOFS * (rotor.first_node[place.shaft] + element)
    row = np.zeros(rotor.size)
    # The slope of y is -θx, that of x is θy.
    row[x : x + NODE_DOFS] = _along(angle, at_first, tilt_first)
    row[x + NODE_DOFS : x + 2 * NODE_DOFS] = _along(angle, at_second, tilt_second)
    pedestal = machine.pedestal_under(place)
    if pedestal is not None:
        stands = NODE_DOFS * rotor.pedestal_node[pedestal.id]
        row[stands : stands + 2] = -math.cos(angle), -math.sin(angle)
    return row


def _along(angle: float, at: float, tilt: float) -> Floats:
    return np.array([math.cos(angle) * at, math.sin(angle) * at, -math.sin(angle) * tilt, math.cos(angle) * tilt])


def _shape_functions(*, part: float, length: float, shear: float) -> tuple[float, float, float, float]:
    """Compute the displacement at a part of an element per displacement and slope at its two ends; shear: 12EI/(κGAl²)."""
    s, bubble = part, shear / 2 * (part - part**2)
    return (
        (1 - 3 * s**2 + 2 * s**3 + shear * (1 - s)) / (1 + shear),
        length * (s - 2 * s**2 + s**3 + bubble) / (1 + shear),
        (3 * s**2 - 2 * s**3 + shear * s) / (1 + shear),
        length * (s**3 - s**2 - bubble) / (1 + shear),
    )


def _shear_parameter(machine: Machine, section: Section, length: float) -> float:
    nu = machine.materials[section.material].poisson_ratio
    kappa = shear_coefficient(poisson_ratio=nu, diameter_ratio=section.inner_diameter / section.outer_diameter)
    # 12EI/(κGAl²) with G = E/2(1+ν) and I/A = (D² + d²)/16.
    return 1.5 * (1 + nu) * (section.outer_diameter**2 + section.inner_diameter**2) / (kappa * length**2)


def _section_at(machine: Machine, shaft: str, station: float) -> Section:
    sections = machine.shaft(shaft).sections
    ends = np.cumsum([section.length for section in sections])
    return sections[min(int(np.searchsorted(ends, station, side="right")), len(sections) - 1)]


def _require_on_shaft(machine: Machine, place: Probe) -> None:
    lengths = {shaft.id: shaft.length for shaft in machine.shafts}
    if place.shaft not in lengths:
        raise ValueError(f"place '{place.id}': '{place.shaft}' is not one of the shafts: {', '.join(lengths)}")
    if place.station > lengths[place.shaft] + STATION_TOLERANCE:
        length = lengths[place.shaft]
        raise ValueError(f"place '{place.id}': {place.station} m lies beyond shaft '{place.shaft}', {length:.6g} m long")
