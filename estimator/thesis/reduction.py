"""Three ways to reduce a flexible train to the degrees of freedom that are measured.

Chapter 3 eliminates the internal degrees of freedom exactly; bearings and couplings stay. Chapter 4 goes on to the bearings'
translations alone: first a dynamic condensation, exact but for gyroscopic effect and shaft damping, to bearings, couplings and
discs; then the high-frequency condensation, which replaces couplings and discs by -Mₛₛ⁻¹Mₛₘ times the bearings'
displacements, as if stiffness did not matter there.
"""

import numpy as np

from estimator.arrays import Floats
from estimator.thesis.flexible_train import FlexibleTrain, Indices, dynamic_stiffness, unbalance_force
from estimator.thesis.reduced_model import ReducedModel


def eliminated(train: FlexibleTrain, *, speed: Floats, direction: Floats) -> ReducedModel:
    """The train over its interface degrees of freedom, without any approximation (Eq. 3.24-3.35).

    speed: (S,) [rad/s], positive. direction: (S,) +1 or -1.
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
    """What the dynamic condensation retains: bearing translations, couplings, disc translations (Eq. 4.53)."""
    others = np.setdiff1d(np.concatenate([train.coupling, train.disc]), train.bearing)
    return np.concatenate([train.bearing, others])


def dynamic_transformation(train: FlexibleTrain, *, speed: Floats) -> Floats:
    """Tᵈ (S, N, m) from the m masters to all degrees of freedom, without damping and gyroscopic effect (Eq. 4.47-4.51)."""
    masters = dynamic_masters(train)
    slaves = np.setdiff1d(np.arange(train.size), masters)
    stiffness = train.stiffness - speed[:, None, None] ** 2 * train.mass
    transformation = np.zeros((speed.size, train.size, masters.size))
    transformation[:, masters, np.arange(masters.size)] = 1.0
    transformation[:, slaves] = -np.linalg.solve(stiffness[:, slaves[:, None], slaves], stiffness[:, slaves[:, None], masters])
    return transformation


def high_frequency_transformation(train: FlexibleTrain, *, speed: Floats) -> Floats:
    """Tᵈ Tʰ (S, N, h) from the h bearing translations to all degrees of freedom (Eq. 4.54-4.57)."""
    dynamic = dynamic_transformation(train, speed=speed)
    mass = np.swapaxes(dynamic, 1, 2) @ train.mass @ dynamic
    kept = train.bearing.size
    inertial = -np.linalg.solve(mass[:, kept:, kept:], mass[:, kept:, :kept])
    return np.asarray(dynamic[:, :, :kept] + dynamic[:, :, kept:] @ inertial)


def reduced(train: FlexibleTrain, transformation: Floats, *, speed: Floats, direction: Floats) -> ReducedModel:
    """The train with its displacements tied to n masters by a transformation (S, N, n) (Eq. 4.52, 4.55)."""
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
    """The train over bearing translations, couplings and disc translations (Eq. 4.52)."""
    return reduced(train, dynamic_transformation(train, speed=speed), speed=speed, direction=direction)


def high_frequency_condensed(train: FlexibleTrain, *, speed: Floats, direction: Floats) -> ReducedModel:
    """The train over bearing translations alone (Eq. 4.55)."""
    return reduced(train, high_frequency_transformation(train, speed=speed), speed=speed, direction=direction)
