"""Reduction of a long train with given coefficients to the modes that it has at some spin speeds.

A proper orthogonal decomposition of the shapes and left vectors at a few speeds (Sirovich, Quart. Appl. Math. 45 (1987) 561):
between those the modes change so smoothly that they are combinations of them. Left vectors are in it as well, so that an
eigenvalue's error is of second order. A search over hundreds of speeds is cheap in it.
"""

from collections.abc import Callable

import numpy as np

from estimator.arrays import Floats
from estimator.modes.eigenmodes import Modes, modes
from estimator.rotor.identity_cache import cached_by_identity
from estimator.rotor.modal_reduction import Basis, in_planes
from estimator.rotor.system_matrices import SystemMatrices

SPEEDS = (0.0, 0.5, 1.0)
"""Speeds at which modes are taken, as parts of the highest spin speed [-]."""
BEYOND = 1.25
"""Highest frequency of the modes that are taken, as a multiple of the highest one asked for [-]."""
HEAVILY_DAMPED = 0.95
"""Damping ratio from which on a mode is left out, as it is not felt [-]."""
SMALLEST_PART = 3e-6
"""Singular value, over the largest, up to which a shape is left out [-]: eigenvalues are then right to about 1e-7."""


def snapshot_basis(
    matrices: Callable[[float], SystemMatrices],
    *,
    direction: int,
    fastest: float,
    highest: float,
    smallest: float = SMALLEST_PART,
) -> Basis:
    """Compute shapes of the modes that a train has up to a frequency and a spin speed (Sirovich 1987).

    Source: Sirovich, Quart. Appl. Math. 45 (1987) 561.

    Args:
        matrices: Function that returns the matrices at a spin speed [rad/s].
        direction: Sense of rotation, +1 or -1.
        fastest: Highest spin speed [rad/s].
        highest: Highest frequency [rad/s].
        smallest: Singular value, over the largest, up to which a shape is left out [-].

    Returns:
        The basis.
    """
    found = [modes(matrices(part * fastest), spin=direction * part * fastest) for part in SPEEDS]
    snapshots = np.concatenate([_shapes(one, BEYOND * highest) for one in found], axis=1)
    orthogonal, size, _ = np.linalg.svd(snapshots, full_matrices=True)
    kept = int(np.count_nonzero(size > smallest * size[0]))
    kept = min(kept + kept % 2, len(orthogonal))
    return Basis(orthogonal[:, :kept])


def projected_matrices(matrices: Callable[[float], SystemMatrices], basis: Basis) -> Callable[[float], SystemMatrices]:
    """Project matrices over the spin speed on a basis, with the latest results cached.

    Args:
        matrices: Function that returns the matrices at a spin speed [rad/s].
        basis: The basis.

    Returns:
        Function of the spin speed [rad/s] that returns the matrices over the basis' coordinates.
    """
    shapes = basis.shapes

    @cached_by_identity
    def over(here: SystemMatrices) -> SystemMatrices:
        return here.project(shapes)

    return lambda speed: over(matrices(speed))


def _shapes(found: Modes, highest: float) -> Floats:
    """Collect shapes and left vectors of modes up to a frequency [rad/s] in either plane, real and imaginary part,
    normalised."""
    slow = (found.eigenvalue.imag <= highest) & (found.damping_ratio < HEAVILY_DAMPED)
    vectors = np.concatenate([found.shape[:, slow], found.left[:, slow]], axis=1)
    vectors = vectors / np.linalg.norm(vectors, axis=0)
    planes = np.concatenate(in_planes(vectors), axis=1)
    return np.concatenate([planes.real, planes.imag], axis=1)
