"""Assembly of a train's shafts and discs: the part of a machine that is known before anything is identified.

Shafts and discs are the same in every direction across the axis, so one bending plane is enough: the full matrices over (x, y,
θx, θy) per node are built from plane matrices over (displacement, slope) per node.
"""

import numpy as np
from msgspec import Struct

from estimator.arrays import Floats, Indices
from estimator.machine.document import Machine
from estimator.machine.mesh import node_stations
from estimator.machine.parts import STATION_TOLERANCE, Disc, Half, Pedestal, Section, Shaft
from estimator.rotor.identity_cache import cached_by_identity
from estimator.rotor.shaft_element import NODE_DOFS, PLANE_DOFS, plane_element

PEDESTAL_PART = 1e-9
"""Part of a pedestal's mass that stands in the rotor's matrices [-]: all of it is a coefficient, but no mass may be zero."""
PEDESTAL_TILT = 1e6
"""Frequency of a pedestal's tilt, which nothing drives: far above all others [rad/s]."""


class PlaneMatrices(Struct, frozen=True, eq=False):
    """Matrices of one bending plane over (displacement, slope) per node.

    Attributes:
        mass: Mass matrix (N/2, N/2) [kg, kg m, kg m²].
        gyroscopic: Gyroscopic matrix (N/2, N/2) per unit spin speed [kg, kg m, kg m²].
        stiffness: Stiffness matrix (N/2, N/2) [N/m, N, N m].
    """

    mass: Floats
    gyroscopic: Floats
    stiffness: Floats

    @classmethod
    def zero(cls, size: int) -> "PlaneMatrices":
        """Return matrices of zeros.

        Args:
            size: Number of degrees of freedom of the plane.

        Returns:
            Matrices to assemble into.
        """
        return cls(np.zeros((size, size)), np.zeros((size, size)), np.zeros((size, size)))

    def freeze(self) -> None:
        """Make the matrices read-only once everything is assembled."""
        for matrix in (self.mass, self.gyroscopic, self.stiffness):
            matrix.flags.writeable = False


class Rotor(Struct, frozen=True, eq=False):
    """Free-free shafts with their discs, and the pedestals apart from them, M q̈ + (C + Ω G) q̇ + (K + Ω H) q = f.

    Matrices (N, N) are computed when asked for: those of a long train, kept with it, would fill the memory.

    Attributes:
        stations: Stations of the nodes (n,) by shaft id [m].
        first_node: Number of the first node by shaft id.
        pedestal_node: Number of the node of each pedestal by its id.
        discs: Matrices of discs and coupling halves in a plane.
        materials: Matrices of the shafts by material; stiffness is in proportion to E and mass to ρ.
        internal: Internal damping β by material [s].
        rayleigh: External damping of the shafts, α [1/s] and β [s].
    """

    stations: dict[str, Floats]
    first_node: dict[str, int]
    pedestal_node: dict[str, int]
    discs: PlaneMatrices
    materials: dict[str, PlaneMatrices]
    internal: dict[str, float]
    rayleigh: tuple[float, float] = (0.0, 0.0)

    @property
    def size(self) -> int:
        """Return the number of degrees of freedom N."""
        return 2 * self.plane_size

    @property
    def plane_size(self) -> int:
        """Return the number of degrees of freedom in one bending plane, N/2."""
        return int(self.discs.mass.shape[0])

    @property
    def mass(self) -> Floats:
        """Assemble the mass matrix M (N, N) [kg, kg m, kg m²]."""
        return both_planes(self.discs.mass + sum(part.mass for part in self.materials.values()))

    @property
    def gyroscopic(self) -> Floats:
        """Assemble the gyroscopic matrix G (N, N), skew-symmetric [kg, kg m, kg m²]."""
        return across_planes(self.discs.gyroscopic + sum(part.gyroscopic for part in self.materials.values()))

    @property
    def stiffness(self) -> Floats:
        """Assemble the stiffness matrix K (N, N) [N/m, N, N m]."""
        return both_planes(self.discs.stiffness + sum(part.stiffness for part in self.materials.values()))

    @property
    def damping(self) -> Floats:
        """Assemble the damping matrix C (N, N) [N s/m, N s, N m s].

        It holds the external damping αM + βK of the shafts, and their internal damping.
        """
        alpha, beta = self.rayleigh
        parts = (alpha * m.mass + (beta + self.internal[name]) * m.stiffness for name, m in self.materials.items())
        return both_planes(sum(parts, np.zeros_like(self.discs.mass)))

    @property
    def circulatory(self) -> Floats:
        """Assemble the circulatory matrix H (N, N) per unit spin speed [N s/m, N s, N m s].

        Internal damping acts on the velocity in the rotating shaft, which at rest in space leaves C (-Ω × q).
        """
        parts = (self.internal[name] * m.stiffness for name, m in self.materials.items())
        return across_planes(sum(parts, np.zeros_like(self.discs.mass)))

    def node(self, shaft: str, station: float) -> int:
        """Return the number of the node at a station of a shaft.

        Args:
            shaft: Id of the shaft.
            station: Station from the driver-side end [m].

        Returns:
            Number of the node.

        Raises:
            ValueError: No node is there.
        """
        stations = self.stations[shaft]
        nearest = int(np.argmin(np.abs(stations - station)))
        if abs(stations[nearest] - station) > 2 * STATION_TOLERANCE:
            raise ValueError(f"no node at station {station} m of shaft '{shaft}'")
        return self.first_node[shaft] + nearest

    def end_node(self, shaft: str) -> int:
        """Return the number of the node at the driven-side end of a shaft.

        Args:
            shaft: Id of the shaft.

        Returns:
            Number of the node.
        """
        return self.first_node[shaft] + len(self.stations[shaft]) - 1


def plane_columns(size: int) -> tuple[Floats, Floats]:
    """Assemble the maps from (displacement, slope) per node in either bending plane to (x, y, θx, θy) per node.

    The slope of the y-z plane is -θx.

    Args:
        size: Number N of degrees of freedom.

    Returns:
        Maps (N, N/2) from the x-z plane and from the y-z plane [-].
    """
    nodes = size // NODE_DOFS
    x_plane, y_plane = np.zeros((size, size // 2)), np.zeros((size, size // 2))
    first, plane = NODE_DOFS * np.arange(nodes), PLANE_DOFS * np.arange(nodes)
    x_plane[first, plane] = x_plane[first + 3, plane + 1] = 1.0
    y_plane[first + 1, plane], y_plane[first + 2, plane + 1] = 1.0, -1.0
    return x_plane, y_plane


def both_planes(matrix: Floats) -> Floats:
    """Assemble the matrix that acts in each bending plane as the given one.

    Args:
        matrix: Matrix (N/2, N/2) of one plane [any unit].

    Returns:
        Matrix (N, N) [unit of the argument].
    """
    x_rows, y_rows, sign = _plane_rows(len(matrix))
    whole = np.zeros((2 * len(matrix), 2 * len(matrix)))
    whole[np.ix_(x_rows, x_rows)] = matrix
    whole[np.ix_(y_rows, y_rows)] = sign[:, None] * matrix * sign
    return whole


def across_planes(matrix: Floats) -> Floats:
    """Assemble the skew-symmetric matrix by which motion in one plane acts in the other.

    A motion in the y-z plane enters the x-z plane with the given matrix, and back with a minus.

    Args:
        matrix: Matrix (N/2, N/2) [any unit].

    Returns:
        Matrix (N, N) [unit of the argument].
    """
    x_rows, y_rows, sign = _plane_rows(len(matrix))
    whole = np.zeros((2 * len(matrix), 2 * len(matrix)))
    whole[np.ix_(x_rows, y_rows)] = matrix * sign
    whole[np.ix_(y_rows, x_rows)] = -sign[:, None] * matrix
    return whole


def _plane_rows(size: int) -> tuple[Indices, Indices, Floats]:
    """Return the rows of the x-z plane and of the y-z plane, and the signs of the latter, see `plane_columns`.

    The products with these maps are copies with signs: done as products they take seconds for a long train.
    """
    first = NODE_DOFS * np.arange(size // PLANE_DOFS)
    x_rows = np.stack([first, first + 3], axis=1).reshape(-1)
    y_rows = np.stack([first + 1, first + 2], axis=1).reshape(-1)
    return x_rows, y_rows, np.tile([1.0, -1.0], size // PLANE_DOFS)


@cached_by_identity
def assemble_rotor(machine: Machine) -> Rotor:
    """Assemble the matrices of all shafts and discs (thesis Eq. 3.1-3.6, 3.10-3.11).

    Args:
        machine: The machine.

    Returns:
        The rotor, read-only.
    """
    rotor = _rotor_without_mass(machine)
    for shaft in machine.shafts:
        _add_shaft(rotor, machine, shaft)
    for disc in machine.discs:
        _add_body(rotor, rotor.node(disc.shaft, disc.station), disc)
    for coupling in machine.couplings:
        if coupling.driver_half is not None:
            _add_body(rotor, rotor.end_node(coupling.driver), coupling.driver_half)
        if coupling.driven_half is not None:
            _add_body(rotor, rotor.first_node[coupling.driven], coupling.driven_half)
    for pedestal in machine.pedestals:
        _add_pedestal(rotor, rotor.pedestal_node[pedestal.id], pedestal)
    for part in (rotor.discs, *rotor.materials.values()):
        part.freeze()
    return rotor


def _rotor_without_mass(machine: Machine) -> Rotor:
    """Lay out the nodes of a machine, shaft by shaft and then the pedestals; all matrices are zero."""
    stations = {shaft.id: node_stations(machine, shaft) for shaft in machine.shafts}
    first_node: dict[str, int] = {}
    nodes = 0
    for shaft in machine.shafts:
        first_node[shaft.id] = nodes
        nodes += len(stations[shaft.id])
    pedestal_node = {one.id: node for node, one in enumerate(machine.pedestals, start=nodes)}
    nodes += len(pedestal_node)
    used = {section.material for shaft in machine.shafts for section in shaft.sections}
    names = [name for name in machine.materials if name in used]
    return Rotor(
        stations=stations,
        first_node=first_node,
        pedestal_node=pedestal_node,
        discs=PlaneMatrices.zero(PLANE_DOFS * nodes),
        materials={name: PlaneMatrices.zero(PLANE_DOFS * nodes) for name in names},
        internal={name: machine.materials[name].internal_damping for name in names},
        rayleigh=(machine.damping.alpha, machine.damping.beta),
    )


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
        element = plane_element(
            length=stop - start,
            outer_diameter=section.outer_diameter,
            inner_diameter=section.inner_diameter,
            young_modulus=material.young_modulus,
            density=material.density,
            poisson_ratio=material.poisson_ratio,
        )
        first = PLANE_DOFS * (rotor.first_node[shaft.id] + i)
        block = slice(first, first + 2 * PLANE_DOFS)
        part = rotor.materials[section.material]
        part.mass[block, block] += element.translation + element.rotation
        # A thin slice's polar inertia is twice its diametral one.
        part.gyroscopic[block, block] += 2 * element.rotation
        part.stiffness[block, block] += element.stiffness


def _add_body(rotor: Rotor, node: int, body: Disc | Half) -> None:
    displacement, slope = PLANE_DOFS * node, PLANE_DOFS * node + 1
    rotor.discs.mass[displacement, displacement] += body.mass
    rotor.discs.mass[slope, slope] += body.diametral_inertia
    rotor.discs.gyroscopic[slope, slope] += body.polar_inertia


def _add_pedestal(rotor: Rotor, node: int, pedestal: Pedestal) -> None:
    displacement, slope = PLANE_DOFS * node, PLANE_DOFS * node + 1
    mass = PEDESTAL_PART * min(pedestal.mxx, pedestal.myy)
    rotor.discs.mass[displacement, displacement] += mass
    rotor.discs.mass[slope, slope] += mass
    rotor.discs.stiffness[slope, slope] += mass * PEDESTAL_TILT**2
