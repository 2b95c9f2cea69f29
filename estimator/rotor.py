"""Assembly of a train's shafts and discs: what is known of a machine before anything is identified."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimator.machine import STATION_TOLERANCE, Bearing, Disc, Machine, Probe, Section, Shaft
from estimator.shaft import NODE_DOFS, shaft_element

DEFAULT_ELEMENTS_PER_SHAFT = 12


@dataclass(frozen=True)
class Rotor:
    """Free-free shafts with their discs, M q̈ + Ω G q̇ + K q = f.

    stations: per shaft id the node stations [m]; first_node: per shaft id the number of its first node.
    mass, gyroscopic, stiffness: (N, N) with N = 4 × nodes, order (x, y, θx, θy) per node.
    """

    stations: dict[str, NDArray[np.float64]]
    first_node: dict[str, int]
    mass: NDArray[np.float64]
    gyroscopic: NDArray[np.float64]
    stiffness: NDArray[np.float64]

    @property
    def size(self) -> int:
        """Number of degrees of freedom."""
        return int(self.mass.shape[0])

    def node(self, shaft: str, station: float) -> int:
        """Number of the node at a station [m] of a shaft. Raises ValueError when no node is there."""
        stations = self.stations[shaft]
        nearest = int(np.argmin(np.abs(stations - station)))
        if abs(stations[nearest] - station) > 2 * STATION_TOLERANCE:
            raise ValueError(f"no node at station {station} m of shaft '{shaft}'")
        return self.first_node[shaft] + nearest

    def end_node(self, shaft: str) -> int:
        """Number of the node at the driven-side end of a shaft."""
        return self.first_node[shaft] + len(self.stations[shaft]) - 1


def assemble_rotor(machine: Machine) -> Rotor:
    """Mass, gyroscopic and stiffness matrices of all shafts and discs (thesis Eq. 3.1-3.6, 3.10-3.11)."""
    stations = {shaft.id: node_stations(machine, shaft) for shaft in machine.shafts}
    first_node: dict[str, int] = {}
    nodes = 0
    for shaft in machine.shafts:
        first_node[shaft.id] = nodes
        nodes += len(stations[shaft.id])
    size = NODE_DOFS * nodes
    rotor = Rotor(stations, first_node, np.zeros((size, size)), np.zeros((size, size)), np.zeros((size, size)))
    for shaft in machine.shafts:
        _add_shaft(rotor, machine, shaft)
    _add_discs(rotor, machine)
    return rotor


def node_stations(machine: Machine, shaft: Shaft) -> NDArray[np.float64]:
    """Stations [m] of a shaft's nodes: section ends, every part's place, and enough between for the element length."""
    ends = np.concatenate([[0.0], np.cumsum([section.length for section in shaft.sections])])
    parts: list[Disc | Bearing | Probe] = [*machine.discs, *machine.bearings, *machine.probes]
    places = [part.station for part in parts if part.shaft == shaft.id]
    wanted = np.unique(np.concatenate([ends, np.minimum(places, ends[-1])]))
    fixed = [0.0]
    for station in wanted:
        if station - fixed[-1] > STATION_TOLERANCE:
            fixed.append(float(station))
    longest = machine.element_length or ends[-1] / DEFAULT_ELEMENTS_PER_SHAFT
    pieces = [np.array(fixed[:1])]
    for start, stop in zip(fixed[:-1], fixed[1:], strict=True):
        # A hair of slack keeps a span of exactly the longest length in one piece.
        count = max(1, int(np.ceil((stop - start) / longest - 1e-6)))
        pieces.append(np.linspace(start, stop, count + 1)[1:])
    return np.concatenate(pieces)


def _section_at(shaft: Shaft, station: float) -> Section:
    end = 0.0
    for section in shaft.sections:
        end += section.length
        if station < end:
            return section
    return shaft.sections[-1]


def _add_shaft(rotor: Rotor, machine: Machine, shaft: Shaft) -> None:
    stations = rotor.stations[shaft.id]
    for i, (start, stop) in enumerate(zip(stations[:-1], stations[1:], strict=True)):
        section = _section_at(shaft, (start + stop) / 2)
        material = machine.materials[section.material]
        element = shaft_element(
            length=stop - start,
            outer_diameter=section.outer_diameter,
            inner_diameter=section.inner_diameter,
            young_modulus=material.young_modulus,
            density=material.density,
            poisson_ratio=material.poisson_ratio,
        )
        first = NODE_DOFS * (rotor.first_node[shaft.id] + i)
        block = slice(first, first + 2 * NODE_DOFS)
        rotor.mass[block, block] += element.mass
        rotor.gyroscopic[block, block] += element.gyroscopic
        rotor.stiffness[block, block] += element.stiffness


def _add_discs(rotor: Rotor, machine: Machine) -> None:
    for disc in machine.discs:
        x = NODE_DOFS * rotor.node(disc.shaft, disc.station)
        theta_x, theta_y = x + 2, x + 3
        rotor.mass[[x, x + 1], [x, x + 1]] += disc.mass
        rotor.mass[[theta_x, theta_y], [theta_x, theta_y]] += disc.diametral_inertia
        rotor.gyroscopic[theta_x, theta_y] += disc.polar_inertia
        rotor.gyroscopic[theta_y, theta_x] -= disc.polar_inertia
