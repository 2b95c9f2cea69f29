"""Three ways to reduce a flexible train to the degrees of freedom that are measured.

Chapter 3 eliminates the internal degrees of freedom exactly; bearings and couplings stay. Chapter 4 goes on to the bearings'
translations alone: first a dynamic condensation, exact but for gyroscopic effect and shaft damping, to bearings, couplings and
discs; then the high-frequency condensation, which replaces couplings and discs by -Mₛₛ⁻¹Mₛₘ times the bearings'
displacements, as if stiffness did not matter there.
"""

import numpy as np

from estimator.arrays import Floats, Indices
from estimator.thesis.flexible_train import FlexibleTrain, dynamic_stiffness, unbalance_force
from estimator.thesis.reduced_model import ReducedModel


def eliminated(train: FlexibleTrain, *, speed: Floats, direction: Floats) -> ReducedModel:
    """Reduce a train to its interface degrees of freedom, without any approximation (thesis Eq. 3.24-3.35).

    Args:
        train: The train.
        speed: Speeds (S,), positive [rad/s].
        direction: Senses of rotation (S,), +1 or -1 [-].

    Returns:
        The reduced train.
    """
    kept = train.interface
    inner = np.setdiff1d(np.arange(train.size), kept)
    stiffness = dynamic_stiffness(train, speed=speed, direction=direction)
    force = unbalance_force(train, speed=speed, direction=direction)
    across = np.concatenate([stiffness[:, inner[:, None], kept], force[:, inner]], axis=2)
    # Multiplied by the coupling block, the solution takes the internal degrees of freedom out of both sides at once.
    taken = stiffness[:, kept[:, None], inner] @ np.linalg.solve(stiffness[:, inner[:, None], inner], across)
    return ReducedModel(
        speed=speed,
        known=stiffness[:, kept[:, None], kept] - taken[:, :, : kept.size],
        force=force[:, kept] - taken[:, :, kept.size :],
        left=np.broadcast_to(train.left[kept], (speed.size, kept.size, train.left.shape[1])),
        right=np.broadcast_to(train.right[kept], (speed.size, kept.size, train.right.shape[1])),
        viscous=train.viscous,
    )


def dynamic_masters(train: FlexibleTrain) -> Indices:
    """List what the dynamic condensation retains: bearing translations, couplings, disc translations (thesis Eq. 4.53).

    Args:
        train: The train.

    Returns:
        Degrees of freedom (m,).
    """
    others = np.setdiff1d(np.concatenate([train.coupling, train.disc]), train.bearing)
    return np.concatenate([train.bearing, others])


def dynamic_transformation(train: FlexibleTrain, *, speed: Floats) -> Floats:
    """Compute Tᵈ from the m masters to all degrees of freedom, without damping and gyroscopic effect (thesis Eq. 4.47-4.51).

    Args:
        train: The train.
        speed: Speeds (S,) [rad/s].

    Returns:
        Tᵈ (S, N, m) [-].
    """
    masters = dynamic_masters(train)
    slaves = np.setdiff1d(np.arange(train.size), masters)
    stiffness = train.stiffness - speed[:, None, None] ** 2 * train.mass
    transformation = np.zeros((speed.size, train.size, masters.size))
    transformation[:, masters, np.arange(masters.size)] = 1.0
    transformation[:, slaves] = -np.linalg.solve(stiffness[:, slaves[:, None], slaves], stiffness[:, slaves[:, None], masters])
    return transformation


def high_frequency_transformation(train: FlexibleTrain, *, speed: Floats) -> Floats:
    """Compute Tᵈ Tʰ from the h bearing translations to all degrees of freedom (thesis Eq. 4.54-4.57).

    Args:
        train: The train.
        speed: Speeds (S,) [rad/s].

    Returns:
        Tᵈ Tʰ (S, N, h) [-].
    """
    dynamic = dynamic_transformation(train, speed=speed)
    mass = np.swapaxes(dynamic, 1, 2) @ train.mass @ dynamic
    kept = train.bearing.size
    inertial = -np.linalg.solve(mass[:, kept:, kept:], mass[:, kept:, :kept])
    return np.asarray(dynamic[:, :, :kept] + dynamic[:, :, kept:] @ inertial)


def reduced(train: FlexibleTrain, transformation: Floats, *, speed: Floats, direction: Floats) -> ReducedModel:
    """Reduce a train by tying its displacements to n masters (thesis Eq. 4.52, 4.55).

    Args:
        train: The train.
        transformation: Transformation (S, N, n) from the masters to all degrees of freedom [-].
        speed: Speeds (S,) [rad/s].
        direction: Senses of rotation (S,), +1 or -1 [-].

    Returns:
        The reduced train.
    """
    transposed = np.swapaxes(transformation, 1, 2)
    return ReducedModel(
        speed=speed,
        known=np.asarray(transposed @ dynamic_stiffness(train, speed=speed, direction=direction) @ transformation),
        force=np.asarray(transposed @ unbalance_force(train, speed=speed, direction=direction)),
        left=transposed @ train.left,
        right=transposed @ train.right,
        viscous=train.viscous,
    )


def dynamically_condensed(train: FlexibleTrain, *, speed: Floats, direction: Floats) -> ReducedModel:
    """Reduce a train to bearing translations, couplings and disc translations (thesis Eq. 4.52).

    Args:
        train: The train.
        speed: Speeds (S,) [rad/s].
        direction: Senses of rotation (S,), +1 or -1 [-].

    Returns:
        The reduced train.
    """
    return reduced(train, dynamic_transformation(train, speed=speed), speed=speed, direction=direction)


def high_frequency_condensed(train: FlexibleTrain, *, speed: Floats, direction: Floats) -> ReducedModel:
    """Reduce a train to bearing translations alone (thesis Eq. 4.55).

    Args:
        train: The train.
        speed: Speeds (S,) [rad/s].
        direction: Senses of rotation (S,), +1 or -1 [-].

    Returns:
        The reduced train.
    """
    return reduced(train, high_frequency_transformation(train, speed=speed), speed=speed, direction=direction)
