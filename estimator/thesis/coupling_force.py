"""What a coupling transmits: the thesis's misalignment forces and moments (Eq. 2.11-2.12)."""

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.shaft import NODE_DOFS
from estimator.thesis.flexible_train import FlexibleTrain


def coupling_force(
    train: FlexibleTrain, *, coupling: int, coefficients: Floats, displacement: Complexes, speed: Floats
) -> Complexes:
    """Phasors (S, 4) of F_x, F_y [N] and of the moments about x and y [N m] that the driver half exerts on the driven half.

    coupling: its number in the machine document, from 0. coefficients: (K,) SI, of all elements. displacement: (S, 8) of
    the driver half, then of the driven half, each (x, y, θx, θy) [m, rad]. speed: (S,) [rad/s].
    Raises IndexError for a coupling that the train does not have, ValueError for a displacement of another shape.
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
