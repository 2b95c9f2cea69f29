"""A crossing of a mode with the synchronous line, corrected from a guess.

Newton's method on the two-sided Rayleigh functional yᴴ D(λ, Ω) x with Ω = Im λ, vectors by inverse iteration (K. Schreiber,
Nonlinear eigenvalue problems: Newton-type methods and nonlinear Rayleigh functionals, thesis, TU Berlin 2008).
"""

from collections.abc import Callable

import numpy as np
import scipy

from estimator.arrays import Complexes
from estimator.modes.eigenmodes import Modes
from estimator.rotor.system_matrices import SystemMatrices

CORRECTIONS = 15
"""Most corrections of one crossing."""
TOLERANCE = 1e-10
"""Relative change of λ at which a crossing is found [-]."""
BESIDE = 1e-9
"""Relative distance from an eigenvalue at which inverse iteration finds its vectors [-]."""
ITERATIONS = 3
"""Number of steps of inverse iteration."""


def corrected_crossing(matrices: Callable[[float], SystemMatrices], guess: Modes, *, direction: int) -> Modes | None:
    """Correct a crossing with the synchronous line by Newton's method (Schreiber 2008, module's docstring).

    Source: K. Schreiber, Nonlinear eigenvalue problems: Newton-type methods and nonlinear Rayleigh functionals, thesis, TU
    Berlin, 2008.

    Args:
        matrices: Function that returns the matrices at a spin speed [rad/s].
        guess: A single mode near the crossing.
        direction: Sense of rotation, +1 from +x to +y, else -1.

    Returns:
        The mode at the crossing; None where Newton's method does not find it.
    """
    root, shape, left = complex(guess.eigenvalue[0]), guess.shape[:, 0], guess.left[:, 0]
    for turn in range(CORRECTIONS):
        here = matrices(root.imag)
        spin = direction * root.imag
        whole = here.dynamic_stiffness(root, spin=spin)
        by_root = 2 * root * here.mass + here.damping + spin * here.gyroscopic
        by_spin = direction * (here.circulatory + root * here.gyroscopic)
        residual, own, turning = (complex(np.vdot(left, part @ shape)) for part in (whole, by_root, by_spin))
        # residual + own (dσ + j dΩ) + turning dΩ = 0, two real equations.
        columns = own, 1j * own + turning
        equations = np.array([[part.real for part in columns], [part.imag for part in columns]])
        if abs(np.linalg.det(equations)) <= np.finfo(float).tiny:
            return None
        growth, rate = np.linalg.solve(equations, [-residual.real, -residual.imag])
        root += complex(growth, rate)
        if not root.imag > 0.0:
            return None
        # The guess may come from a projection, in which nothing is left to correct before its vectors are.
        if turn > 0 and abs(complex(growth, rate)) <= TOLERANCE * abs(root):
            return Modes(np.array([root]), shape[:, None], (left / np.conj(np.vdot(left, by_root @ shape)))[:, None])
        factor = scipy.linalg.lu_factor(matrices(root.imag).dynamic_stiffness(root, spin=direction * root.imag))
        shape = scipy.linalg.lu_solve(factor, by_root @ shape)
        left = scipy.linalg.lu_solve(factor, np.conj(by_root).T @ left, trans=2)
        shape, left = shape / np.sqrt(np.vdot(shape, here.mass @ shape).real), left / np.linalg.norm(left)
    return None


def mode_by_inverse_iteration(matrices: SystemMatrices, eigenvalue: complex, *, spin: float) -> tuple[Complexes, Complexes]:
    """Compute shape and left vector of a mode whose eigenvalue is known, by inverse iteration.

    Source: K. Schreiber, Nonlinear eigenvalue problems: Newton-type methods and nonlinear Rayleigh functionals, thesis, TU
    Berlin, 2008.

    Args:
        matrices: Matrices of the train with N degrees of freedom.
        eigenvalue: Eigenvalue λ [rad/s].
        spin: Spin speed with sign [rad/s].

    Returns:
        Shape and left vector (N,), scaled as in `Modes` [-].
    """
    near = eigenvalue * (1.0 + BESIDE)
    factor = scipy.linalg.lu_factor(matrices.dynamic_stiffness(near, spin=spin))
    by_root = 2 * eigenvalue * matrices.mass + matrices.damping + spin * matrices.gyroscopic
    shape = left = np.ones(matrices.mass.shape[0], dtype=complex)
    for _ in range(ITERATIONS):
        shape = scipy.linalg.lu_solve(factor, by_root @ shape)
        left = scipy.linalg.lu_solve(factor, np.conj(by_root).T @ left, trans=2)
        shape, left = shape / np.sqrt(np.vdot(shape, matrices.mass @ shape).real), left / np.linalg.norm(left)
    return shape, np.asarray(left / np.conj(np.vdot(left, by_root @ shape)))
