"""Forces and moments that the coupling of the rigid train transmits: the thesis's misalignment curves (Eq. 2.11-2.12)."""

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.condensation import CondensedTrain
from estimator.thesis.rigid_train import Y

COUPLING = "coupling.C"


def misalignment_force(train: CondensedTrain, *, coefficients: Floats, displacement: Complexes) -> Complexes:
    """Phasors (S, 4) of F_x, F_y [N] and of the moments M_xz, M_yz [N m] of the coupling.

    train: a rigid train at S speeds. coefficients: (42,) in its order. displacement: (S, 8) [m].
    The sign of a moment is that of the thesis's φ_y1 - φ_y2 and φ_x1 - φ_x2.
    """
    items = train.unknowns.coefficients
    force = np.zeros((train.speed.size, 4), dtype=complex)
    for k, item in enumerate(items):
        if item.element != COUPLING:
            continue
        rate = 1j * train.speed if item.quantity == "damping" else 1.0
        effort = coefficients[k] * (displacement @ train.right[:, k]) * rate
        in_y = bool(np.any(train.left[Y:, k]))
        if item.quantity == "angular stiffness":
            force[:, 2 + in_y] += effort
        else:
            force[:, int(in_y)] += effort
    return force
