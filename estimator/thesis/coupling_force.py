"""Forces that a coupling transmits: the thesis's misalignment forces and moments (Eq. 2.11-2.12)."""

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.rotor.shaft_element import NODE_DOFS
from estimator.thesis.flexible_train import FlexibleTrain


def coupling_force(
    train: FlexibleTrain, *, coupling: int, coefficients: Floats, displacement: Complexes, speed: Floats
) -> Complexes:
    """Compute the forces and moments that the driver half of a coupling exerts on the driven half (thesis Eq. 2.11-2.12).

    Args:
        train: The train.
        coupling: Number of the coupling in the machine document, from 0.
        coefficients: Coefficients (K,) of all elements [SI].
        displacement: Displacements (S, 8) of the driver half, then of the driven half, each (x, y, θx, θy) [m, rad].
        speed: Speeds (S,) [rad/s].

    Returns:
        Phasors (S, 4) of F_x, F_y [N] and of the moments about x and y [N m].

    Raises:
        IndexError: The train has no such coupling.
        ValueError: The displacement has another shape.
    """
    if not 0 <= coupling < train.coupling.size // (2 * NODE_DOFS):
        raise IndexError(f"the train has no coupling number {coupling}")
    if displacement.shape != (speed.size, 2 * NODE_DOFS):
        raise ValueError(f"the displacement has shape {displacement.shape}, should have {(speed.size, 2 * NODE_DOFS)}")
    ends = train.coupling[2 * NODE_DOFS * coupling : 2 * NODE_DOFS * (coupling + 1)]
    left, right = train.left[ends], train.right[ends]
    # A bearing at the same node shares rows with the coupling, but its vectors miss the other half.
    own = np.any(left[:NODE_DOFS], axis=0) & np.any(left[NODE_DOFS:], axis=0)
    rate = np.where(train.viscous[own], 1j * speed[:, None], 1.0)
    stretch = displacement @ right[:, own]
    return np.asarray((stretch * rate * coefficients[own]) @ left[:NODE_DOFS, own].T)
