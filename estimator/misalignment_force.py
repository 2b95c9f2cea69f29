"""Forces and moments in a coupling over speed: what misalignment loads bearings and shaft ends with (thesis Eq. 2.11-2.12).

F = (k + jωc) times the displacement of the driver's half relative to the driven one's; M = k_phi times the relative slope.
The thesis's M_xz (moment in the x-z plane) is the moment about y here, its M_yz the one about x. Displacements come from the
updated model, as §4.6 of the thesis suggests, because slopes are not measured.
"""

from dataclasses import dataclass

import numpy as np

from estimator.condensation import Floats
from estimator.error_propagation import PhasorBand, by_coordinate, phasor_band
from estimator.parameters import dense
from estimator.rotor import assemble_rotor
from estimator.shaft import NODE_DOFS
from estimator.unbalance_response import unbalance_response
from estimator.updated_model import UpdatedModel


@dataclass(frozen=True)
class CouplingForce:
    """What one coupling carries at S speeds [rad/s], as 1× phasors with 95 % bands.

    force_x, force_y: (S,) [N]; moment_x, moment_y: (S,) about x and y [N m]. The coupling pushes its driven half with them
    and its driver half with the opposite.
    """

    coupling: str
    speed: Floats
    force_x: PhasorBand
    force_y: PhasorBand
    moment_x: PhasorBand
    moment_y: PhasorBand


def coupling_forces(model: UpdatedModel, *, speed: Floats) -> tuple[CouplingForce, ...]:
    """Forces and moments in each coupling of a machine in its sense of rotation, in the document's order.

    speed: (S,) spin speed [rad/s], positive. Raises ValueError for speeds that are not.
    """
    return tuple(_coupling_force(model, coupling.id, np.asarray(speed)) for coupling in model.machine.couplings)


def _coupling_force(model: UpdatedModel, coupling: str, speed: Floats) -> CouplingForce:
    """A load is Σ p r d over its coefficients p, r = 1 or jω and d the deformation that each acts on."""
    numbered = enumerate(model.unknowns.coefficients)
    own = {k: one for k, one in numbered if one.element == f"coupling.{coupling}"}
    rows = dense([one.right for one in own.values()], assemble_rotor(model.machine).size).T
    deformation, slope = unbalance_response(model, speed=speed, rows=rows)
    viscous = np.array([one.quantity == "damping" for one in own.values()])
    rate = np.where(viscous, 1j * speed[:, None], 1.0)  # (S, 10)
    each = model.coefficients[list(own)] * rate
    load_slope = each[:, :, None] * slope
    for i, k in enumerate(own):
        load_slope[:, i, k] += rate[:, i] * deformation[:, i]
    bands = []
    for dof in range(NODE_DOFS):
        members = [i for i, one in enumerate(own.values()) if min(one.left) % NODE_DOFS == dof]
        total = by_coordinate(model, load_slope[:, members].sum(axis=1))
        bands.append(phasor_band((each * deformation)[:, members].sum(axis=1), total, model.covariance))
    return CouplingForce(coupling, speed, *bands)
