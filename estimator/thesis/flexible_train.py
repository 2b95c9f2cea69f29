"""The train of the thesis's Chapters 3 and 4: flexible shafts as finite elements, every degree of freedom at hand.

The dynamic stiffness over all N degrees of freedom is Z = K - ω²M + jω(C + ΩG) + Σ p·a bᵀ (1 or jω), with C the shafts'
Rayleigh damping (thesis Eq. 3.1-3.23; G has the sign of rotation from +x to +y, and the ω before the bracket of Eq. 3.10
is read as the jω that Eq. 3.18 has).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats, Indices
from estimator.machine.document import Machine
from estimator.rotor.assembly import Rotor, assemble_rotor
from estimator.rotor.parameters import Unknowns, dense, unknowns
from estimator.rotor.rayleigh import RayleighCoefficients
from estimator.rotor.shaft_element import NODE_DOFS


@dataclass(frozen=True)
class FlexibleTrain:
    """A train with N degrees of freedom, K unknown coefficients and P unknown unbalances.

    Attributes:
        mass: Mass matrix (N, N) of shafts and discs [kg, kg m, kg m²].
        gyroscopic: Gyroscopic matrix (N, N) of shafts and discs [kg, kg m, kg m²].
        damping: Damping matrix (N, N) of the shafts [N s/m, N s, N m s].
        stiffness: Stiffness matrix (N, N) of the shafts [N/m, N, N m].
        left: Vectors a (N, K) of the coefficients [-].
        right: Vectors b (N, K) of the coefficients [-].
        viscous: True where a coefficient acts on the velocity (K,).
        bearing: Degrees of freedom (2 per bearing,): translations at the bearings.
        coupling: Degrees of freedom (8 per coupling,): translations and rotations of both halves.
        disc: Degrees of freedom (2 per disc,): translations at the discs.
        unknowns: Names and nominal values.
    """

    mass: Floats
    gyroscopic: Floats
    damping: Floats
    stiffness: Floats
    left: Floats
    right: Floats
    viscous: NDArray[np.bool_]
    bearing: Indices
    coupling: Indices
    disc: Indices
    unknowns: Unknowns

    @property
    def size(self) -> int:
        """Return the number of degrees of freedom."""
        return int(self.mass.shape[0])

    @property
    def interface(self) -> Indices:
        """Return the degrees of freedom (n,) at bearings and couplings.

        The unknown coefficients act there (the thesis's B and C).
        """
        return np.concatenate([self.bearing, np.setdiff1d(self.coupling, self.bearing)])


def flexible_train(machine: Machine, *, rayleigh: RayleighCoefficients | None = None) -> FlexibleTrain:
    """Assemble a machine (thesis Eq. 3.1-3.23).

    Args:
        machine: The machine.
        rayleigh: Damping of its shafts, not of its discs (Eq. 3.5 and 3.11); None for none.

    Returns:
        The train.
    """
    rotor = assemble_rotor(machine)
    unknown = unknowns(machine, rotor)
    damping = np.zeros_like(rotor.mass)
    if rayleigh is not None:
        damping = rayleigh.matrix(mass=_shaft_mass(machine, rotor), stiffness=rotor.stiffness)
    halves = [node for c in machine.couplings for node in (rotor.end_node(c.driver), rotor.first_node[c.driven])]
    return FlexibleTrain(
        mass=rotor.mass,
        gyroscopic=rotor.gyroscopic,
        damping=damping,
        stiffness=rotor.stiffness,
        left=dense([c.left for c in unknown.coefficients], rotor.size),
        right=dense([c.right for c in unknown.coefficients], rotor.size),
        viscous=np.array([c.quantity == "damping" for c in unknown.coefficients]),
        bearing=_degrees([rotor.node(b.shaft, b.station) for b in machine.bearings], count=2),
        coupling=_degrees(halves, count=NODE_DOFS),
        disc=_degrees([plane.node for plane in unknown.unbalances], count=2),
        unknowns=unknown,
    )


def dynamic_stiffness(train: FlexibleTrain, *, speed: Floats, direction: Floats) -> Complexes:
    """Compute the known part of Z (thesis Eq. 3.18).

    Args:
        train: The train.
        speed: Spin speeds (S,) [rad/s].
        direction: Senses of rotation (S,), +1 or -1 [-].

    Returns:
        Known part of Z (S, N, N) [N/m, N, N m].
    """
    omega = speed[:, None, None]
    spin = (speed * direction)[:, None, None]
    return np.asarray(train.stiffness - omega**2 * train.mass + 1j * omega * (train.damping + spin * train.gyroscopic))


def unbalance_force(train: FlexibleTrain, *, speed: Floats, direction: Floats) -> Complexes:
    """Compute the forces per real and imaginary part of each unbalance (thesis Eq. 3.35; its mirror image against +x to +y).

    Args:
        train: The train.
        speed: Spin speeds (S,) [rad/s].
        direction: Senses of rotation (S,), +1 or -1 [-].

    Returns:
        Forces (S, N, 2P) per unbalance [N/(kg m)].
    """
    force = np.zeros((speed.size, train.size, 2 * len(train.unknowns.unbalances)), dtype=complex)
    square = speed**2
    for plane, item in enumerate(train.unknowns.unbalances):
        x = NODE_DOFS * item.node
        force[:, x, 2 * plane], force[:, x + 1, 2 * plane] = square, -1j * direction * square
        force[:, x, 2 * plane + 1], force[:, x + 1, 2 * plane + 1] = 1j * direction * square, square
    return force


def full_response(
    train: FlexibleTrain, *, coefficients: Floats, unbalances: Complexes, speed: Floats, direction: Floats
) -> Complexes:
    """Compute the phasors of every degree of freedom (thesis Eq. 3.23, 4.42).

    Args:
        train: The train.
        coefficients: Coefficients (K,) [SI].
        unbalances: Complex unbalances (P,) [kg m].
        speed: Spin speeds (S,), positive [rad/s].
        direction: Senses of rotation (S,), +1 or -1 [-].

    Returns:
        Phasors (S, N) [m, rad].
    """
    elastic = (train.left * np.where(train.viscous, 0.0, coefficients)) @ train.right.T
    viscous = (train.left * np.where(train.viscous, coefficients, 0.0)) @ train.right.T
    whole = dynamic_stiffness(train, speed=speed, direction=direction) + elastic + 1j * speed[:, None, None] * viscous
    force = unbalance_force(train, speed=speed, direction=direction) @ parts(unbalances)
    return np.asarray(np.linalg.solve(whole, force[..., None])[..., 0])


def parts(unbalances: Complexes) -> Floats:
    """Separate complex unbalances into real and imaginary parts, one pair after the other (thesis Eq. 3.36).

    Args:
        unbalances: Complex unbalances (..., P) [kg m].

    Returns:
        Parts (..., 2P) [kg m].
    """
    return np.stack([unbalances.real, unbalances.imag], axis=-1).reshape(*unbalances.shape[:-1], -1)


def _degrees(nodes: list[int], *, count: int) -> Indices:
    return np.array([NODE_DOFS * node + dof for node in nodes for dof in range(count)], dtype=np.intp)


def _shaft_mass(machine: Machine, rotor: Rotor) -> Floats:
    mass = rotor.mass.copy()
    for disc in machine.discs:
        x = NODE_DOFS * rotor.node(disc.shaft, disc.station)
        mass[range(x, x + 4), range(x, x + 4)] -= [disc.mass, disc.mass, disc.diametral_inertia, disc.diametral_inertia]
    return mass
