"""Response of a train together with its exact derivatives by every unknown."""

import numpy as np

from estimator.condensation import Complexes, CondensedTrain, Floats


def sensitivity(train: CondensedTrain, *, coefficients: Floats, unbalances: Complexes) -> tuple[Complexes, Complexes]:
    """Phasors (S, m) [m] and their derivatives (S, m, K + 2P) by the coefficients and by the parts of the unbalances.

    From Z q = F: ∂q/∂p = -Z⁻¹ (∂Z/∂p) q with ∂Z/∂p = a bᵀ (or jω a bᵀ), and q is linear in the unbalances. A response to
    U = 0 has no derivative by the coefficients.
    """
    inverse = np.linalg.inv(train.dynamic_stiffness(coefficients))
    receptance = train.output @ inverse  # (S, m, n)
    by_unbalance = receptance @ train.force  # (S, m, 2P)
    parts = np.stack([unbalances.real, unbalances.imag], axis=-1).reshape(-1)
    displacement = (inverse @ (train.force @ parts)[..., None])[..., 0]  # (S, n)
    rate = np.where(train.damping, 1j * train.speed[:, None], 1.0)  # (S, K)
    strain = -(displacement @ train.right) * rate  # (S, K)
    by_coefficient = (receptance @ train.left) * strain[:, None, :]
    return by_unbalance @ parts, np.concatenate([by_coefficient, by_unbalance], axis=-1)
