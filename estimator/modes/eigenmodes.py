"""Modes of a train at a spin speed: damped natural frequencies, shapes, and their derivatives by the coefficients."""

from typing import Any

import numpy as np
import scipy
from msgspec import Struct

from estimator.arrays import Complexes, Floats
from estimator.machine.document import Machine
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.modal_reduction import EVERYTHING, Basis
from estimator.rotor.parameters import dense, unknowns
from estimator.rotor.system_matrices import SystemMatrices, system_matrices

OSCILLATING = 1e-6
"""Part of |λ| that Im λ exceeds where a mode oscillates [-]."""


class Modes(Struct, frozen=True, eq=False):
    """Oscillating modes, n of them, by ascending damped natural frequency.

    They are over N degrees of freedom, or as many coordinates of a basis.

    Attributes:
        eigenvalue: Eigenvalues λ (n,) with positive imaginary part [rad/s].
        shape: Displacements x (N, n) of x e^{λt}, scaled to xᴴMx = 1 [1/√kg].
        left: Left vectors y (N, n), yᴴ (K + ΩH + λ(C + ΩG) + λ²M) = 0, scaled to yᴴ (2λM + C + ΩG) x = 1 [SI].
    """

    eigenvalue: Complexes
    shape: Complexes
    left: Complexes

    @property
    def damping_ratio(self) -> Floats:
        """Return the damping ratios -Re λ / |λ| (n,) [-]; negative for a mode that grows."""
        return damping_ratio(self.eigenvalue)


def damping_ratio(eigenvalue: Complexes) -> Floats:
    """Compute the damping ratio -Re λ / |λ|.

    Args:
        eigenvalue: Eigenvalues λ (...), of any shape [rad/s].

    Returns:
        Damping ratios (...), negative for modes that grow [-].
    """
    return np.asarray(-eigenvalue.real / np.abs(eigenvalue))


def log_decrement(eigenvalue: Complexes) -> Floats:
    """Compute the logarithmic decrement -2π Re λ / Im λ: logarithm of the ratio of successive maxima (API 684).

    Args:
        eigenvalue: Eigenvalues λ (...), of any shape [rad/s].

    Returns:
        Logarithmic decrements (...) [-].
    """
    return np.asarray(-2 * np.pi * eigenvalue.real / eigenvalue.imag)


def modes(matrices: SystemMatrices, *, spin: float, left_vectors: bool = True) -> Modes:
    """Solve for the oscillating modes of a train at a spin speed; overdamped ones are left out.

    Source: standard result: eigenvalues and eigenvectors of the train's state matrix.

    Args:
        matrices: Matrices of the train.
        spin: Spin speed, signed as the sense of rotation [rad/s].
        left_vectors: Whether left vectors are computed; without them `left` is (N, 0), and they take a quarter of the time.

    Returns:
        The modes.
    """
    size = matrices.mass.shape[0]
    # scipy's type stubs know nothing of three results.
    solution: Any = scipy.linalg.eig(matrices.state_matrix(spin=spin), left=left_vectors, right=True)
    roots, right = solution[0], solution[-1]
    chosen = np.flatnonzero(roots.imag > OSCILLATING * np.abs(roots))
    chosen = chosen[np.argsort(roots[chosen].imag, kind="stable")]
    eigenvalue, shape = roots[chosen], right[:size, chosen]
    shape = shape / np.sqrt(np.real(np.sum(np.conj(shape) * (matrices.mass @ shape), axis=0)))
    if not left_vectors:
        return Modes(eigenvalue=eigenvalue, shape=shape, left=np.empty((size, 0), dtype=complex))
    left = solution[1]
    # A left vector (w₁, w₂) of the state matrix holds that of the quadratic problem as M⁻¹w₂.
    factor = scipy.linalg.cho_factor(matrices.mass)
    adjoint = scipy.linalg.cho_solve(factor, left[size:, chosen])
    resistance = matrices.damping + spin * matrices.gyroscopic
    momentum = 2 * (matrices.mass @ shape) * eigenvalue + resistance @ shape
    product = np.sum(np.conj(adjoint) * momentum, axis=0)
    return Modes(eigenvalue=eigenvalue, shape=shape, left=adjoint / np.conj(product))


def eigenvalue_slopes(machine: Machine, found: Modes, basis: Basis = EVERYTHING) -> Complexes:
    """Compute ∂λ/∂p of each mode by each coefficient: -yᴴ (∂Z/∂p) x.

    Source: Nelson, AIAA J. 14 (1976) 1201, doi:10.2514/3.7211, for the quadratic problem. Modes of exactly equal eigenvalue
    have no slope of their own; their values here are only as good as the vectors that were found for them.

    Args:
        machine: The machine, with K coefficients.
        found: n modes.
        basis: Basis of the modes, by default all degrees of freedom.

    Returns:
        Derivatives (n, K) [rad/s per SI unit of the coefficient].
    """
    rotor = assemble_rotor(machine)
    unknown = unknowns(machine, rotor).coefficients
    pairs = [pair for one in unknown for pair in one.pairs]
    left, right = (basis.project(dense(list(side), rotor.size)) for side in zip(*pairs, strict=True))
    acting = (np.conj(found.left).T @ left) * (found.shape.T @ right)
    first = np.concatenate([[0], np.cumsum([len(one.pairs) for one in unknown])[:-1]])
    order = np.array([one.order for one in unknown])
    return np.asarray(-np.add.reduceat(acting, first, axis=1) * found.eigenvalue[:, None] ** order)


def eigenvalues(machine: Machine, *, coefficients: Floats | None = None, spin: float = 0.0) -> Complexes:
    """Solve for the eigenvalues with positive imaginary part; overdamped modes are left out.

    Im λ is the damped natural frequency, |λ| the undamped one, -Re λ / |λ| the damping ratio.

    Source: standard result: eigenvalues of the train's state matrix.

    Args:
        machine: The machine.
        coefficients: Coefficients (K,) [SI]; None for the expected ones.
        spin: Spin speed, signed as the sense of rotation [rad/s].

    Returns:
        Eigenvalues λ (n,) by ascending imaginary part [rad/s].
    """
    roots = np.linalg.eigvals(system_matrices(machine, coefficients=coefficients).state_matrix(spin=spin))
    oscillating = roots[roots.imag > OSCILLATING * np.abs(roots)]
    return np.asarray(oscillating[np.argsort(oscillating.imag)])


def natural_frequencies(machine: Machine, *, coefficients: Floats | None = None, spin: float = 0.0) -> Floats:
    """Solve for the damped natural frequencies of a train; see `eigenvalues`.

    Args:
        machine: The machine.
        coefficients: Coefficients (K,) [SI]; None for the expected ones.
        spin: Spin speed, signed as the sense of rotation [rad/s].

    Returns:
        Damped natural frequencies (n,), ascending [rad/s].
    """
    return np.asarray(eigenvalues(machine, coefficients=coefficients, spin=spin).imag)
