"""Regression of the thesis's Chapter 2: the equations of motion with measured displacements, linear in the 50 unknowns.

Z(p) q = F u becomes Σ p_k a_k (b_kᵀ q)(1 or jω) - F u = -Z_known q (Eq. 2.13-2.17). Where the print's [kʳ], [cʳ] and [uʳ]
differ from Eq. 2.10, the equation is followed: 1/16 and not 0.062, +jω and not -jω, e^{jφ} and not e^{jωφ}.

Noise in q stands in the matrix too, so that the estimate is biased by it.
"""

import numpy as np

from estimator.arrays import Complexes
from estimator.rotor.condensation import CondensedTrain
from estimator.thesis.regression import Regression, real_rows


def rigid_regression(train: CondensedTrain, displacement: Complexes) -> Regression:
    """Build the regression A x = b over all S speeds of a train, in both senses of rotation if it has them.

    Source: thesis Eq. 2.13-2.17; the unbalances' columns are scaled by one over the mean spin speed (end of §2.3.2). The
    unknowns are those of `rigid_train.names()`.

    Args:
        train: The train.
        displacement: Measured phasors (S, n) of all degrees of freedom [m].

    Returns:
        The regression.

    Raises:
        ValueError: The displacement has another shape.
    """
    wanted = train.known.shape[:2]
    if displacement.shape != wanted:
        raise ValueError(f"displacement has shape {displacement.shape}, should have {wanted}: speeds by degrees of freedom")
    rate = (1j * train.speed[:, None]) ** train.order
    by_coefficient = train.left * ((displacement @ train.right) * rate)[:, None, :]
    matrix = np.concatenate([by_coefficient, -train.force], axis=-1)
    target = -(train.known @ displacement[..., None])[..., 0]
    planes = [f"{plane.name}.{part}" for plane in train.unknowns.unbalances for part in ("real", "imaginary")]
    of_unbalance = np.arange(matrix.shape[-1]) >= train.order.size
    return Regression(
        matrix=real_rows(matrix.reshape(-1, matrix.shape[-1])),
        target=real_rows(target.reshape(-1)),
        names=(*(one.name for one in train.unknowns.coefficients), *planes),
        thesis_scale=np.where(of_unbalance, 1.0 / np.mean(train.speed), 1.0),
    )
