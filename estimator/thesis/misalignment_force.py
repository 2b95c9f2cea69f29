"""Forces and moments that the coupling of the rigid train transmits: the thesis's misalignment curves (Eq. 2.11-2.12)."""

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.rotor.condensation import CondensedTrain
from estimator.thesis.rigid_train import Y

COUPLING = "coupling.C"
"""Name of the coupling."""


def misalignment_force(train: CondensedTrain, *, coefficients: Floats, displacement: Complexes) -> Complexes:
    """Compute forces and moments of the coupling (thesis Eq. 2.11-2.12).

    The sign of a moment is that of the thesis's φ_y1 - φ_y2 and φ_x1 - φ_x2.

    Args:
        train: A rigid train at S speeds.
        coefficients: Coefficients (42,) in its order [N/m, N m/rad, N s/m].
        displacement: Displacements (S, 8) [m].

    Returns:
        Phasors (S, 4) of F_x, F_y [N] and of the moments M_xz, M_yz [N m].
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
