"""Response of the updated model to its unbalances, at any linear combination of its degrees of freedom, with exact slopes.

The same response as `response` gives at the probes, without condensation: slopes of couplings and places between the probes
are degrees of freedom that condensation would have to keep.
"""

import numpy as np

from estimator.condensation import Complexes, Floats
from estimator.parameters import Unknowns, dense
from estimator.shaft import NODE_DOFS
from estimator.system_matrices import system_matrices
from estimator.updated_model import UpdatedModel


def unbalance_response(model: UpdatedModel, *, speed: Floats, rows: Floats) -> tuple[Complexes, Complexes]:
    """Phasors (S, R) of rows (R, N) times q, and their derivatives (S, R, K + 2P) by coefficients and parts of unbalances.

    speed: (S,) [rad/s], in the machine's sense of rotation. q over all degrees of freedom, [m] and [rad]. From Z q = F:
    ∂q/∂p = -Z⁻¹ a r bᵀq with r = 1 or jω. Raises ValueError for speeds that are not positive.
    """
    speed = np.asarray(speed, dtype=float)
    if speed.ndim != 1 or not np.all(np.isfinite(speed) & (speed > 0)):
        raise ValueError("speed must be a list of positive, finite spin speeds [rad/s]")
    unknown, direction = model.unknowns, model.machine.direction
    matrices = system_matrices(model.machine, coefficients=model.coefficients)
    size, count = matrices.mass.shape[0], len(unknown.coefficients)
    left = dense([one.left for one in unknown.coefficients], size)
    right = dense([one.right for one in unknown.coefficients], size)
    damping = np.array([one.quantity == "damping" for one in unknown.coefficients])
    parts = np.stack([model.unbalances.real, model.unbalances.imag], axis=-1).reshape(-1)
    value = np.empty((speed.size, rows.shape[0]), dtype=complex)
    slope = np.empty((*value.shape, count + parts.size), dtype=complex)
    for i, omega in enumerate(speed):
        stiffness = matrices.dynamic_stiffness(1j * omega, spin=direction * omega)
        receptance = np.linalg.solve(stiffness.T, rows.T).T  # (R, N)
        force = _unbalance_force(unknown, size, float(omega), direction)
        deformation = right.T @ np.linalg.solve(stiffness, force @ parts)  # (K,)
        value[i] = receptance @ (force @ parts)
        slope[i, :, :count] = -(receptance @ left) * (np.where(damping, 1j * omega, 1.0) * deformation)
        slope[i, :, count:] = receptance @ force
    return value, slope


def _unbalance_force(unknown: Unknowns, size: int, omega: float, direction: int) -> Complexes:
    """Force columns (N, 2P): ω² U (1, -j) for rotation from +x to +y; its mirror image, with U conjugate, against it."""
    force = np.zeros((size, 2 * len(unknown.unbalances)), dtype=complex)
    for plane, item in enumerate(unknown.unbalances):
        x = NODE_DOFS * item.node
        force[x : x + 2, 2 * plane] = omega**2 * np.array([1.0, -1j * direction])
        force[x : x + 2, 2 * plane + 1] = omega**2 * np.array([1j * direction, 1.0])
    return force
