"""The thesis's regression: the equations of motion with measured displacements put in, linear in the unknowns.

Z(p) q = F u becomes Σ p_k a_k (b_kᵀ q)(1 or jω) - F u = -Z_known q (Eq. 2.13, 3.41). Noise in q then stands in the matrix,
and the estimate is biased by it.
"""

from typing import Literal

import numpy as np

from estimator.condensation import Complexes, CondensedTrain
from estimator.thesis.regression import Regression, real_rows

ScaledColumns = Literal["unbalance", "damping and unbalance"]
"""Columns that the thesis scales by one over the mean spin speed: those of Chapter 2, those of Chapters 3 and 4."""


def equation_error(train: CondensedTrain, displacement: Complexes, *, scaled: ScaledColumns) -> Regression:
    """The regression A x = b over all speeds of a train, real parts of all equations first.

    displacement: (S, n) measured phasors of all retained degrees of freedom [m, rad]. The unknowns are the coefficients,
    then real and imaginary part of each unbalance. Raises ValueError for a displacement of the wrong shape.
    """
    samples, size = train.known.shape[:2]
    if displacement.shape != (samples, size):
        raise ValueError(f"displacement has shape {displacement.shape}, should have {(samples, size)}: all retained DOFs")
    rate = np.where(train.damping, 1j * train.speed[:, None], 1.0)
    by_coefficient = train.left * ((displacement @ train.right) * rate)[:, None, :]
    matrix = np.concatenate([by_coefficient, -train.force], axis=-1)
    target = -(train.known @ displacement[..., None])[..., 0]
    slowed = np.ones(matrix.shape[-1], dtype=bool)
    slowed[: train.damping.size] = train.damping & (scaled == "damping and unbalance")
    planes = [f"{plane.name}.{part}" for plane in train.unknowns.unbalances for part in ("real", "imaginary")]
    return Regression(
        matrix=real_rows(matrix.reshape(-1, matrix.shape[-1])),
        target=real_rows(target.reshape(-1)),
        names=(*(one.name for one in train.unknowns.coefficients), *planes),
        thesis_scale=np.where(slowed, 1.0 / np.mean(train.speed), 1.0),
    )
