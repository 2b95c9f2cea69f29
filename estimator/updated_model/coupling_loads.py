"""Forces and moments in a coupling over speed: the loads of misalignment on bearings and shaft ends (thesis Eq. 2.11-2.12).

F = (k + jωc) times the displacement of the driver's half relative to the driven one's; M = k_phi times the relative slope. The
thesis's M_xz (moment in the x-z plane) is the moment about y here, its M_yz the one about x. Displacements come from the
updated model, as §4.6 of the thesis suggests, because slopes are not measured.
"""

from dataclasses import dataclass

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.fit.problem.coordinates import Coordinates
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.condensation import condense, parts_of
from estimator.rotor.parameters import dense, unknowns
from estimator.rotor.shaft_element import NODE_DOFS
from estimator.rotor.whirl import orbit
from estimator.updated_model.forced_response import coefficient_slopes, forced_response
from estimator.updated_model.model import UpdatedModel
from estimator.updated_model.uncertainty import PhasorBand, phasor_band


@dataclass(frozen=True)
class CouplingForce:
    """Loads that one coupling carries at S speeds, as 1× phasors with 95 % bands.

    The coupling pushes its driven half with them and its driver half with the opposite. What its run-out strains it by is in
    them; an equivalent load that was identified acts beside them and is not.

    Attributes:
        coupling: Id of the coupling.
        speed: Speeds (S,) [rad/s].
        force_x: Force along x (S,) [N].
        force_y: Force along y (S,) [N].
        moment_x: Moment about x (S,) [N m].
        moment_y: Moment about y (S,) [N m].
        force: Force (S,) along the major axis of its ellipse, the largest in a turn [N].
        moment: Moment (S,) along the major axis of its ellipse, the largest in a turn [N m].
    """

    coupling: str
    speed: Floats
    force_x: PhasorBand
    force_y: PhasorBand
    moment_x: PhasorBand
    moment_y: PhasorBand
    force: PhasorBand
    moment: PhasorBand


def coupling_forces(model: UpdatedModel, *, speed: Floats) -> tuple[CouplingForce, ...]:
    """Compute forces and moments in each coupling of a machine in its sense of rotation (thesis Eq. 2.11-2.12).

    Args:
        model: The updated model.
        speed: Spin speeds (S,) [rad/s], positive.

    Returns:
        Loads of each coupling in the document's order.

    Raises:
        ValueError: A speed is not positive.
    """
    return tuple(_coupling_force(model, coupling.id, np.asarray(speed)) for coupling in model.machine.couplings)


def _coupling_force(model: UpdatedModel, coupling: str, speed: Floats) -> CouplingForce:
    """Sum a load over the terms that act on it: Σ p r bᵀq, r = (jω)ⁿ."""
    rotor = assemble_rotor(model.machine)
    numbered = enumerate(unknowns(model.machine, rotor).coefficients)
    terms = [(k, one, pair) for k, one in numbered if one.element == f"coupling.{coupling}" for pair in one.pairs]
    rows = dense([right for _, _, (_, right) in terms], rotor.size).T
    found = forced_response(model, speed=speed, output=rows)
    coordinates = model.coordinates_at(speed)
    slopes = coefficient_slopes(coordinates, coordinates.theta(model.values), found.coefficients)
    load = np.zeros((speed.size, NODE_DOFS), dtype=complex)
    load_slope = np.zeros((*load.shape, model.values.size), dtype=complex)
    free, free_slope = _free_of_load(model, coordinates, [k for k, _, _ in terms])
    for i, (k, one, (left, _)) in enumerate(terms):
        component = min(left) % NODE_DOFS
        rate = (1j * speed) ** one.order
        deformation = rate * found.phasor[:, i] - free[i]
        load[:, component] += found.coefficients[:, k] * deformation
        load_slope[:, component] += found.coefficients[:, k, None] * (rate[:, None] * found.slope[:, i] - free_slope[i])
        for place, by_coordinate in slopes.get(k, {}).items():
            load_slope[:, component, place] += by_coordinate * deformation
    bands = [phasor_band(load[:, dof], load_slope[:, dof], model.covariance) for dof in range(NODE_DOFS)]
    largest = [_along_major_axis(load[:, pair], load_slope[:, pair], model) for pair in (slice(0, 2), slice(2, 4))]
    return CouplingForce(coupling, speed, *bands, *largest)


def _free_of_load(model: UpdatedModel, coordinates: Coordinates, owners: list[int]) -> tuple[Complexes, Complexes]:
    """Return the deformation (t,) of a coupling's terms at which its run-out has it free of load, and its slopes (t, n)."""
    slope = np.zeros((len(owners), model.values.size), dtype=complex)
    train = condense(model.machine, speed=np.ones(1), direction=np.full(1, float(model.machine.direction)))
    strain = train.free_strain
    if strain is None:
        return np.zeros(len(owners), dtype=complex), slope
    own = strain[0, np.isin(train.owner, owners)]
    for number, first in enumerate(coordinates.excitation_place):
        if first >= 0:
            slope[:, first : first + 2] = own[:, 2 * number : 2 * number + 2]
    return own @ parts_of(model.excitations), slope


def _along_major_axis(load: Complexes, slope: Complexes, model: UpdatedModel) -> PhasorBand:
    """Project a load (S, 2) with slopes (S, 2, n) on its major axis; to first order the axis itself stays where it is."""
    inclination = orbit(load[:, 0], load[:, 1], direction=model.machine.direction).inclination
    axis = np.stack([np.cos(inclination), np.sin(inclination)], axis=1)
    return phasor_band(np.sum(axis * load, axis=1), np.sum(axis[:, :, None] * slope, axis=1), model.covariance)
