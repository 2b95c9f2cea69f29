"""Response to unbalance and stability of a train, with films or with any coefficients given over speed."""

from collections.abc import Iterator

import numpy as np
import scipy.linalg

from tests.film_plant.arrays import Complexes, Floats, Indices
from tests.film_plant.assembly import Matrices


def with_films(matrices: Matrices, stiffness: Floats, damping: Floats) -> tuple[Floats, Floats]:
    """Stiffness and damping (N, N) of the train with films' coefficients (n, 2, 2) between journals and pedestals."""
    whole, slowed = matrices.stiffness.copy(), matrices.damping.copy()
    for number, rows, columns, sign in film_blocks(matrices):
        whole[np.ix_(rows, columns)] += sign * stiffness[number]
        slowed[np.ix_(rows, columns)] += sign * damping[number]
    return whole, slowed


def film_blocks(matrices: Matrices) -> Iterator[tuple[int, Indices, Indices, float]]:
    """Yield where films act: number of the bearing, degrees of freedom (2,) of rows and of columns, and the sign there."""
    for number, (journal, pedestal) in enumerate(zip(matrices.journals, matrices.pedestals, strict=True)):
        ends = [(journal, 1.0)] if pedestal[0] < 0 else [(journal, 1.0), (pedestal, -1.0)]
        for rows, sign in ends:
            for columns, other in ends:
                yield number, rows, columns, sign * other


def motion(matrices: Matrices, *, speed: Floats, stiffness: Floats, damping: Floats) -> Complexes:
    """Steady motion (S, N) [m, rad] under what turns, at speeds (S,) [rad/s] with coefficients (S, n, 2, 2)."""
    found = np.empty((speed.size, len(matrices.mass)), dtype=complex)
    for row, w, k, c in zip(found, speed, stiffness, damping, strict=True):
        whole, slowed = with_films(matrices, k, c)
        dynamic = whole - w**2 * matrices.mass + 1j * w * (slowed + w * matrices.gyroscopic)
        row[:] = np.linalg.solve(dynamic, w**2 * matrices.unbalance + matrices.turning)
    return found


def at_probes(matrices: Matrices, moved: Complexes, *, absolute: bool = False) -> Complexes:
    """Motion (S, 2n) [m] of the journals along x and y, one bearing after the other, from that of the train (S, N).

    Relative to the pedestals, on which probes usually stand; or absolute.
    """
    seen = moved[:, matrices.journals.ravel()]
    stands = matrices.pedestals.ravel()
    if not absolute:
        seen = seen - np.where(stands >= 0, moved[:, stands], 0.0)
    return np.asarray(seen)


def response(matrices: Matrices, *, speed: Floats, stiffness: Floats, damping: Floats, absolute: bool = False) -> Complexes:
    """Phasors (S, 2n) [m] at the bearings at speeds (S,) [rad/s] with coefficients (S, n, 2, 2)."""
    return at_probes(matrices, motion(matrices, speed=speed, stiffness=stiffness, damping=damping), absolute=absolute)


def eigenvalues(matrices: Matrices, *, speed: float, stiffness: Floats, damping: Floats) -> Complexes:
    """Eigenvalues (2N,) [rad/s] at a speed [rad/s] with coefficients (n, 2, 2)."""
    whole, slowed = with_films(matrices, stiffness, damping)
    return eigenvalues_of(matrices.mass, whole, slowed + speed * matrices.gyroscopic)


def eigenvalues_of(mass: Floats, stiffness: Floats, damping: Floats) -> Complexes:
    """Eigenvalues (2N,) [rad/s] of M q̈ + C q̇ + K q = 0."""
    size = len(mass)
    inverse = scipy.linalg.cho_factor(mass)
    state = np.block(
        [
            [np.zeros((size, size)), np.eye(size)],
            [-scipy.linalg.cho_solve(inverse, stiffness), -scipy.linalg.cho_solve(inverse, damping)],
        ]
    )
    return np.asarray(scipy.linalg.eigvals(state))


def smallest_damping_ratio(values: Complexes, highest: float) -> float:
    """Smallest damping ratio [-] of modes that turn below a frequency [rad/s]; negative where any mode grows.

    High bending modes of the shafts, which nothing excites, have next to no damping in a model without the material's.
    """
    growing = values.real > 1e-6 * np.abs(values).clip(min=1.0)
    if growing.any():
        return -float(np.max(values.real[growing] / np.abs(values[growing])))
    low = values[(values.imag > 1e-3) & (values.imag < highest)]
    return float(np.min(-low.real / np.abs(low)))
