"""A train reduced to n degrees of freedom, its response, and its equations of motion solved for the unknowns.

Chapters 3 and 4 of the thesis differ only in how they reduce: once that is done, each speed gives n complex equations
Σ p·a (bᵀq)(1 or jω) - F u = -Z q that are linear in the unknowns when q is measured (Eq. 3.37-3.41, 4.58-4.71).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.thesis.flexible_train import parts


@dataclass(frozen=True)
class ReducedModel:
    """A train over n retained degrees of freedom at S speeds, with K coefficients and P unbalances.

    Attributes:
        speed: Speeds (S,) [rad/s].
        known: Dynamic stiffness (S, n, n) without the unknowns [N/m, N, N m].
        force: Forces (S, n, 2P) per part of each unbalance [N/(kg m)].
        left: Vectors a (S, n, K) of the coefficients [-].
        right: Vectors b (S, n, K) of the coefficients [-].
        viscous: True where a coefficient acts on the velocity (K,).
    """

    speed: Floats
    known: Complexes
    force: Complexes
    left: Complexes | Floats
    right: Complexes | Floats
    viscous: NDArray[np.bool_]

    @property
    def rate(self) -> Complexes:
        """Return the factor (S, K) with which each coefficient acts: 1 for a stiffness, jω for a damping [-, rad/s]."""
        return np.where(self.viscous, 1j * self.speed[:, None], 1.0)


@dataclass(frozen=True)
class ResponseEquations:
    """Complex equations `coefficient` β + `unbalance` U = `target` of S samples with n rows each.

    Attributes:
        coefficient: Columns (S, n, K) of the coefficients β [SI].
        unbalance: Columns (S, n, 2P) of the unbalances' parts U [SI].
        target: Right-hand side (S, n) [N, N m].
    """

    coefficient: Complexes
    unbalance: Complexes
    target: Complexes


def reduced_response(model: ReducedModel, *, coefficients: Floats, unbalances: Complexes) -> Complexes:
    """Solve for the phasors of the retained degrees of freedom (thesis Eq. 3.37-3.41, 4.58-4.71).

    Args:
        model: The reduced train.
        coefficients: Coefficients (K,), or (S, K) where they depend on the speed [SI].
        unbalances: Complex unbalances (P,), or (S, P) where trial masses come and go [kg m].

    Returns:
        Phasors (S, n) [m, rad].
    """
    unknown = (model.left * (model.rate * coefficients)[:, None, :]) @ np.swapaxes(model.right, 1, 2)
    force = model.force @ parts(unbalances)[..., None]
    return np.asarray(np.linalg.solve(model.known + unknown, force)[..., 0])


def response_equations(model: ReducedModel, displacement: Complexes) -> ResponseEquations:
    """Assemble the equations that measured phasors give (thesis Eq. 3.37, 4.61).

    Args:
        model: The reduced train.
        displacement: Measured phasors (S, n) [m, rad].

    Returns:
        The equations.

    Raises:
        ValueError: The phasors' shape is not (S, n).
    """
    if displacement.shape != model.known.shape[:2]:
        raise ValueError(f"the displacement has shape {displacement.shape}, should have {model.known.shape[:2]}")
    stretch = np.einsum("snk,sn->sk", model.right, displacement) * model.rate
    return ResponseEquations(
        coefficient=np.asarray(model.left * stretch[:, None, :]),
        unbalance=-model.force,
        target=-(model.known @ displacement[..., None])[..., 0],
    )
