"""Static load in each coupling: what the part of the train behind it needs beside its bearings to be in equilibrium.

Shear and moment follow from the balance of forces and of moments about the coupling of all shafts behind it (statics of a free
body), with their weight and static loads; the coupling's stiffness has no part in it.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats
from estimator.machine.coupling_neighbours import shafts_behind
from estimator.machine.document import Machine
from estimator.machine.train_layout import shaft_begins
from estimator.rotor.assembly import assemble_rotor, plane_columns
from estimator.rotor.shaft_element import NODE_DOFS
from estimator.statics.train_statics import train_load


@dataclass(frozen=True)
class CouplingBalance:
    """Balance of the part of a train of n bearings that lies behind a coupling.

    Attributes:
        coupling: Id of the coupling.
        weight: Weight and static loads there along x and y (2,), negative for weight [N].
        moment: Their moments about the coupling in the x-z and the y-z plane (2,) [N m].
        carried: Part of each bearing's film force that acts there (n,), 1 behind the coupling, else 0 [-].
        arm: Distance of each bearing there from the coupling (n,), else 0 [m].
        loaded: Part of each static load that acts there (m,), 1 behind the coupling, else 0 [-].
        load_arm: Distance of each static load there from the coupling (m,), else 0 [m].
    """

    coupling: str
    weight: Floats
    moment: Floats
    carried: Floats
    arm: Floats
    loaded: Floats
    load_arm: Floats


def coupling_balances(machine: Machine) -> tuple[CouplingBalance, ...]:
    """Compute the balance of the part of a train behind each coupling (statics of a free body).

    With f the forces of the films on the journals, the coupling pushes its driven half with the shear -(weight + Σ carried f)
    and turns it by the moment -(moment + Σ arm f); a positive moment turns it as a positive angle does.

    Args:
        machine: The machine.

    Returns:
        Balance of each coupling, in the document's order.
    """
    rotor = assemble_rotor(machine)
    planes = plane_columns(rotor.size)
    load = train_load(machine, rotor)
    begins = shaft_begins(machine)
    found = []
    for coupling in machine.couplings:
        shafts, at = shafts_behind(machine, coupling), begins[coupling.driven]
        # Rigid motions of that part: displacement and slope of each node per unit of height and of slope.
        lifted, turned = np.zeros((2, rotor.size // NODE_DOFS, 2))
        for shaft in shafts:
            stations = rotor.stations[shaft]
            own = slice(rotor.first_node[shaft], rotor.first_node[shaft] + len(stations))
            lifted[own, 0] = turned[own, 1] = 1.0
            turned[own, 0] = begins[shaft] - at + stations
        (carried, arm), (loaded, load_arm) = (
            _levers([(begins[one.shaft] - at + one.station, one.shaft in shafts) for one in parts])
            for parts in (machine.bearings, machine.static_loads)
        )
        weight, moment = (np.array([load @ plane @ motion.reshape(-1) for plane in planes]) for motion in (lifted, turned))
        found.append(CouplingBalance(coupling.id, weight, moment, carried, arm, loaded, load_arm))
    return tuple(found)


def _levers(parts: Sequence[tuple[float, bool]]) -> tuple[Floats, Floats]:
    """Return of parts, by distance from the coupling and whether they are behind it, 1 or 0 and distance or 0 [-, m]."""
    behind = np.array([float(there) for _, there in parts])
    return behind, behind * np.array([distance for distance, _ in parts])
