"""Alignment of a train's couplings: offset and angle of their shafts against each other, from the elevations of the bearings.

Each of the two shafts is taken as it would lie on its own bearings without the coupling. A shaft on two bearings keeps its
shape and is extended to its end by the lever rule; one on more bearings is bent by them (condensed as in `train_statics`).
Elevations are measured from the aligned state. At zero the coupling carries neither shear nor moment when all journals are in
their bearings' centres, whatever the shafts sag by (Piotrowski, Shaft Alignment Handbook, 3rd ed., CRC Press 2006).
"""

from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats
from estimator.machine.document import Machine
from estimator.machine.parts import STATION_TOLERANCE, Bearing, Coupling
from estimator.rotor.assembly import Rotor, assemble_rotor
from estimator.rotor.shaft_element import PLANE_DOFS
from estimator.statics.train_statics import free_motion


@dataclass(frozen=True)
class CouplingAlignment:
    """Offset and angle at a coupling as linear functions of the elevations of all n bearings, the same in either plane.

    Attributes:
        coupling: Id of the coupling.
        offset: Offset (n,) of the driven shaft's end over the driver's, per unit of each bearing's elevation [m/m].
        angle: Slope (n,) of the driven shaft's end over the driver's, in the direction from driver to driven [rad/m].
        undefined: Reason why there is none; None where there is one.
    """

    coupling: str
    offset: Floats
    angle: Floats
    undefined: str | None = None


def coupling_alignments(machine: Machine) -> tuple[CouplingAlignment, ...]:
    """Derive offset and angle at each coupling per unit of each bearing's elevation (lever rule; Piotrowski 2006).

    A positive offset says that the driven shaft's end lies higher, or further along +x. A positive angle says that the driven
    shaft rises, or runs towards +x, on its way from the coupling, as seen from the driver's: the faces open below.

    Args:
        machine: The machine.

    Returns:
        Alignment of each coupling, in the document's order.
    """
    rotor = assemble_rotor(machine)
    return tuple(_alignment(machine, rotor, coupling) for coupling in machine.couplings)


def alignment_motions(machine: Machine) -> dict[str, Floats]:
    """Derive the least motion of the bearings that makes a unit of each offset and angle, and none of any other.

    Source: least-norm solution of the lever rules, by the pseudoinverse (Penrose 1955, doi:10.1017/S0305004100030401).

    Args:
        machine: The machine.

    Returns:
        Motion (n,) of all n bearings, the same in either plane, by name, such as `coupling.C1.offset` [m/m, m/rad].
    """
    each = [one for one in coupling_alignments(machine) if one.undefined is None]
    rows = np.array([row for one in each for row in (one.offset, one.angle)]).reshape(2 * len(each), len(machine.bearings))
    names = [f"coupling.{one.coupling}.{what}" for one in each for what in ("offset", "angle")]
    return dict(zip(names, np.linalg.pinv(rows).T, strict=True))


def _alignment(machine: Machine, rotor: Rotor, coupling: Coupling) -> CouplingAlignment:
    found = np.zeros((PLANE_DOFS, len(machine.bearings)))
    for shaft, sign in ((coupling.driven, 1.0), (coupling.driver, -1.0)):
        own = [(place, one) for place, one in enumerate(machine.bearings) if one.shaft == shaft]
        stations = np.array([one.station for _, one in own])
        if stations.size < 2 or np.ptp(stations) <= STATION_TOLERANCE:
            lone = (
                f"shaft {shaft} does not lie on two bearings of its own, which alone say where its end is without the coupling"
            )
            return CouplingAlignment(coupling.id, np.zeros(found.shape[1]), np.zeros(found.shape[1]), lone)
        at_driven_side = shaft == coupling.driver
        end = rotor.stations[shaft][-1 if at_driven_side else 0]
        found[:, [place for place, _ in own]] += sign * (
            _lever(stations, float(end))
            if stations.size == 2
            else _bent(rotor, shaft, [one for _, one in own], at_driven_side=at_driven_side)
        )
    return CouplingAlignment(coupling.id, found[0], found[1])


def _lever(stations: Floats, end: float) -> Floats:
    """Return displacement and slope (2, 2) of a straight line at `end` per unit of its height at two stations [1, 1/m]."""
    span = stations[1] - stations[0]
    return np.asarray(np.array([[stations[1] - end, end - stations[0]], [-1.0, 1.0]]) / span)


def _bent(rotor: Rotor, shaft: str, bearings: list[Bearing], *, at_driven_side: bool) -> Floats:
    """Return displacement and slope (2, k) of a shaft's end per unit of the elevation of each of its k bearings [1, 1/m]."""
    whole = sum((part.stiffness for part in rotor.materials.values()), np.zeros((rotor.plane_size, rotor.plane_size)))
    first, last = rotor.first_node[shaft], rotor.end_node(shaft)
    own = slice(PLANE_DOFS * first, PLANE_DOFS * (last + 1))
    held = np.array([PLANE_DOFS * (rotor.node(shaft, one.station) - first) for one in bearings], dtype=np.intp)
    stiffness = whole[own, own]
    _, moved = free_motion(stiffness, np.zeros((len(stiffness), 0)), held)
    return np.asarray(moved[-PLANE_DOFS:] if at_driven_side else moved[:PLANE_DOFS])
