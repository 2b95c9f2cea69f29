"""Standard errors of the updated model's natural frequencies and critical speeds.

To first order (JCGM 100:2008, 5.2), with the eigenvalues' derivatives of `estimator.modes.eigenmodes` (Nelson 1976).
"""

import numpy as np
from msgspec.structs import replace

from estimator.arrays import Complexes, Floats
from estimator.modes.critical_speed import CriticalSpeed
from estimator.modes.crossing_correction import mode_by_inverse_iteration
from estimator.modes.eigenmodes import Modes, eigenvalue_slopes, modes
from estimator.rotor.modal_reduction import EVERYTHING
from estimator.updated_model.forced_response import coefficient_slopes
from estimator.updated_model.model import UpdatedModel
from estimator.updated_model.uncertainty import standard_errors

SCALE_STEP = 1e-3
"""Change of the logarithm of E or ρ in a central difference of matrices that are all but linear in it [-]."""
SPEED_STEP = 1e-4
"""Relative change of the spin speed in a central difference [-]: coefficients may follow the speed in any way."""


def modes_at(model: UpdatedModel, *, speed: float) -> Modes:
    """Compute the oscillating modes of the updated model in the machine's sense of rotation.

    Args:
        model: The updated model.
        speed: Spin speed [rad/s, without sign].

    Returns:
        The modes.
    """
    return modes(model.matrices(speed), spin=model.machine.direction * speed)


def eigenvalue_slopes_by_coordinate(model: UpdatedModel, found: Modes, *, speed: float | Floats) -> Complexes:
    """Compute the derivatives of the eigenvalues by the model's n coordinates, the spin speed held.

    Args:
        model: The updated model.
        found: k modes.
        speed: Spin speed of all modes, or of each (k,) [rad/s].

    Returns:
        Derivatives (k, n) [rad/s per unit of the coordinate].
    """
    speeds = np.broadcast_to(np.asarray(speed, dtype=float), found.eigenvalue.shape)
    if speeds.size == 0:  # a stiff train has no mode in reach: curves over speed want a speed
        return np.zeros((0, model.values.size), dtype=complex)
    coordinates = model.coordinates_at(speeds)
    theta = coordinates.theta(model.values)
    coefficients = coordinates.coefficients(theta)
    by_coefficient = eigenvalue_slopes(model.machine, found, model.basis)
    slopes = np.zeros((found.eigenvalue.size, model.values.size), dtype=complex)
    for k, places in coefficient_slopes(coordinates, theta, np.broadcast_to(coefficients, by_coefficient.shape)).items():
        for place, by_coordinate in places.items():
            slopes[:, place] += by_coefficient[:, k] * by_coordinate
    for place in map(int, coordinates.scale_place):
        step = np.zeros(model.values.size)
        step[place] = SCALE_STEP
        ahead, behind = (replace(model, values=model.values + sign * step).matrices for sign in (1, -1))
        for mode, (root, at) in enumerate(zip(found.eigenvalue, speeds, strict=True)):
            spin = model.machine.direction * at
            change = ahead(at).dynamic_stiffness(root, spin=spin) - behind(at).dynamic_stiffness(root, spin=spin)
            slopes[mode, place] = -np.vdot(found.left[:, mode], change @ found.shape[:, mode]) / (2 * SCALE_STEP)
    return slopes


def natural_frequency_errors(model: UpdatedModel, found: Modes, *, speed: float) -> Floats:
    """Compute the standard errors of the damped natural frequencies.

    Args:
        model: The updated model.
        found: k modes.
        speed: Spin speed of the modes [rad/s].

    Returns:
        Standard errors (k,) [rad/s].
    """
    return standard_errors(eigenvalue_slopes_by_coordinate(model, found, speed=speed).imag, model.covariance)


def crossing_slopes(model: UpdatedModel, found: Modes) -> Complexes:
    """Compute the derivatives of the eigenvalues at crossings with the synchronous line by the model's n coordinates.

    The spin speed follows, so that the imaginary part is that of the critical speed: from Im λ(Ω, p) = Ω, dΩ = Im ∂λ/∂p dp /
    (1 - Im ∂λ/∂Ω).

    Args:
        model: The updated model.
        found: The c modes that cross.

    Returns:
        Derivatives (c, n) [rad/s per unit of the coordinate].
    """
    held = eigenvalue_slopes_by_coordinate(model, found, speed=found.eigenvalue.imag)
    by_speed = np.array([_by_speed(model, found, crossing) for crossing in range(found.eigenvalue.size)])[:, None]
    return np.asarray(held + by_speed * held.imag / (1.0 - by_speed.imag))


def critical_speed_errors(model: UpdatedModel, table: tuple[CriticalSpeed, ...]) -> Floats:
    """Compute the standard errors of the model's critical speeds.

    Args:
        model: The updated model.
        table: Its c critical speeds.

    Returns:
        Standard errors (c,) [rad/s].
    """
    crossing = [_vectors(model, one) for one in table]
    if not crossing:
        return np.empty(0)
    eigenvalue = np.array([one.eigenvalue for one in table])
    shape, left = (np.stack(vectors, axis=1) for vectors in zip(*crossing, strict=True))
    return standard_errors(crossing_slopes(model, Modes(eigenvalue, shape, left)).imag, model.covariance)


def _vectors(model: UpdatedModel, one: CriticalSpeed) -> tuple[Complexes, Complexes]:
    """Compute shape and left vector of the mode that crosses."""
    if model.basis is not EVERYTHING:
        return mode_by_inverse_iteration(model.matrices(one.speed), one.eigenvalue, spin=model.machine.direction * one.speed)
    found = modes_at(model, speed=one.speed)
    mode = int(np.argmin(np.abs(found.eigenvalue - one.eigenvalue)))
    return found.shape[:, mode], found.left[:, mode]


def _by_speed(model: UpdatedModel, found: Modes, crossing: int) -> complex:
    """Compute ∂λ/∂Ω of one of the crossing modes."""
    root, direction = complex(found.eigenvalue[crossing]), model.machine.direction
    speed = root.imag
    ahead, behind = (
        model.matrices(at).dynamic_stiffness(root, spin=direction * at)
        for at in (speed * (1.0 + SPEED_STEP), speed * (1.0 - SPEED_STEP))
    )
    change = np.vdot(found.left[:, crossing], (ahead - behind) @ found.shape[:, crossing])
    return complex(-change / (2 * SPEED_STEP * speed))
