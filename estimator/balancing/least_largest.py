"""The correction with the least largest vibration that is left (min–max), within limits.

Minimise t with |b + A c| ≤ t at every point and |c| ≤ L in every plane: a second-order cone program, here by cutting
planes (Kelley, J. SIAM 8 (1960) 703, doi:10.1137/0108053): each circle is its tangents at a few angles, a linear program;
tangents are added where its solution lies outside a circle. Its optimum is a lower bound of t and its solution's largest
residual an upper one, so that the answer says by itself how near to the optimum it is. The criterion is that of Foiles,
Allaire and Gunter (Min-max optimum flexible rotor balancing compared to weighted least squares, IMechE, 2000).
"""

import numpy as np
import scipy

from estimator.arrays import Complexes, Floats
from estimator.balancing.model_balancing import BalancingFailed

FIRST_TANGENTS = 12
"""Number of tangents to each circle at the start."""
CLOSE = 1e-6
"""Relative gap between the bounds of the largest residual at which the search ends [-]."""
MOST_ROUNDS = 200


def least_largest(matrix: Complexes, target: Complexes, limit: Floats) -> Complexes:
    """Minimise max |A c - b| with |c_q| ≤ limit_q.

    Units are those of the arguments.

    Source: cutting planes of Kelley, J. SIAM 8 (1960) 703, doi:10.1137/0108053.

    Args:
        matrix: A (n, Q) [-].
        target: b (n,) [-].
        limit: Largest magnitude (Q,) of each unknown [-]; may be infinite.

    Returns:
        c (Q,) [-].

    Raises:
        BalancingFailed: The bounds of the largest residual did not meet.
    """
    scale = float(np.max(np.abs(target)))
    length = np.linalg.norm(matrix, axis=0)
    free = (limit > 0.0) & (length > 0.0)
    found = np.zeros(limit.size, dtype=complex)
    if scale > 0.0 and np.any(free):
        unit = scale / length[free]
        found[free] = unit * _solve(matrix[:, free] * unit / scale, target / scale, limit[free] / unit)
    return found


def _solve(matrix: Complexes, target: Complexes, limit: Floats) -> Complexes:
    planes = matrix.shape[1]
    bounded = np.flatnonzero(np.isfinite(limit))
    picked: Complexes = np.zeros((bounded.size, planes), dtype=complex)
    picked[np.arange(bounded.size), bounded] = 1.0
    angles = np.arange(FIRST_TANGENTS) * 2 * np.pi / FIRST_TANGENTS
    left = [_tangents(matrix, target, np.tile(angle, target.size), t=1.0) for angle in angles]
    within = [_tangents(picked, np.zeros(bounded.size), np.tile(angle, bounded.size), t=0.0) for angle in angles]
    rows = [row for row, _ in left + within]
    sides = [side for _, side in left] + [side + limit[bounded] for _, side in within]
    best, least = np.zeros(planes, dtype=complex), float(np.max(np.abs(target)))
    for _ in range(MOST_ROUNDS):
        solution, bound = _linear_program(np.concatenate(rows), np.concatenate(sides), planes)
        candidate = solution * np.minimum(1.0, limit / np.maximum(np.abs(solution), 1e-300))
        largest = float(np.max(np.abs(matrix @ candidate - target)))
        if largest < least:
            best, least = candidate, largest
        if least - bound <= CLOSE:
            return best
        residual = matrix @ solution - target
        outside = np.abs(residual) > bound
        row, side = _tangents(matrix[outside], target[outside], np.angle(residual[outside]), t=1.0)
        beyond = np.abs(solution[bounded]) > limit[bounded] * (1 - CLOSE)
        more, allowed = _tangents(picked[beyond], np.zeros(int(beyond.sum())), np.angle(solution[bounded][beyond]), t=0.0)
        rows += [row, more]
        sides += [side, allowed + limit[bounded][beyond]]
    raise BalancingFailed(
        f"no least largest vibration was found: it lies between {bound:.6g} and {least:.6g} of the initial one"
    )


def _tangents(matrix: Complexes, target: Complexes | Floats, angle: Floats, *, t: float) -> tuple[Floats, Floats]:
    """Build Re(e^{-jθ} (A c - b)) ≤ t as rows (n, 2 Q + 1) over real parts, imaginary parts and t, and sides (n,)."""
    turned = np.exp(-1j * angle)
    rows = turned[:, None] * matrix
    whole = np.concatenate([rows.real, -rows.imag, np.full((angle.size, 1), -t)], axis=1)
    return whole, np.asarray(np.real(turned * target))


def _linear_program(rows: Floats, sides: Floats, planes: int) -> tuple[Complexes, float]:
    cost = np.zeros(2 * planes + 1)
    cost[-1] = 1.0
    bounds = [(None, None)] * (2 * planes) + [(0.0, None)]
    found = scipy.optimize.linprog(cost, A_ub=rows, b_ub=sides, bounds=bounds, method="highs")
    if found.x is None or found.fun is None:
        raise BalancingFailed(f"no least largest vibration was found: {found.message}")
    return np.asarray(found.x[:planes] + 1j * found.x[planes:-1], dtype=complex), float(found.fun)
