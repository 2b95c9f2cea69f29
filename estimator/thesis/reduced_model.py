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
    """A train over n retained degrees of freedom at S speeds.

    speed: (S,) [rad/s]. known: (S, n, n) dynamic stiffness without the unknowns. force: (S, n, 2P) per part of each
    unbalance. left, right: (S, n, K) vectors of the coefficients. viscous: (K,) True where one acts on the velocity.
    """

    speed: Floats
    known: Complexes
    force: Complexes
    left: Complexes | Floats
    right: Complexes | Floats
    viscous: NDArray[np.bool_]

    @property
    def rate(self) -> Complexes:
        """1 for a stiffness, jω for a damping coefficient, (S, K)."""
        return np.where(self.viscous, 1j * self.speed[:, None], 1.0)


@dataclass(frozen=True)
class ResponseEquations:
    """Complex equations `coefficient` β + `unbalance` U = `target` of S samples with n rows each.

    coefficient: (S, n, K). unbalance: (S, n, 2P). target: (S, n).
    """

    coefficient: Complexes
    unbalance: Complexes
    target: Complexes


def reduced_response(model: ReducedModel, *, coefficients: Floats, unbalances: Complexes) -> Complexes:
    """Phasors (S, n) of the retained degrees of freedom [m, rad].

    coefficients: (K,), or (S, K) where they depend on the speed. unbalances: (P,), or (S, P) where trial masses come and go
    [kg m].
    """
    unknown = (model.left * (model.rate * coefficients)[:, None, :]) @ np.swapaxes(model.right, 1, 2)
    force = model.force @ parts(unbalances)[..., None]
    return np.asarray(np.linalg.solve(model.known + unknown, force)[..., 0])


def response_equations(model: ReducedModel, displacement: Complexes) -> ResponseEquations:
    """The equations that measured phasors (S, n) give (Eq. 3.37, 4.61).

    Raises ValueError when the phasors' shape is not (S, n).
    """
    if displacement.shape != model.known.shape[:2]:
        raise ValueError(f"the displacement has shape {displacement.shape}, should have {model.known.shape[:2]}")
    stretch = np.einsum("snk,sn->sk", model.right, displacement) * model.rate
    return ResponseEquations(
        coefficient=np.asarray(model.left * stretch[:, None, :]),
        unbalance=-model.force,
        target=-(model.known @ displacement[..., None])[..., 0],
    )
