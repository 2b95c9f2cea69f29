"""How sure the modes of the updated model are: natural frequencies and critical speeds with standard errors."""

from dataclasses import replace

import numpy as np

from estimator.condensation import Complexes, Floats
from estimator.critical_speed import CriticalSpeed
from estimator.error_propagation import standard_errors
from estimator.forced_response import coefficient_slopes
from estimator.modes import Modes, eigenvalue_slopes, modes
from estimator.system_matrices import SystemMatrices, system_matrices
from estimator.updated_model import UpdatedModel

SCALE_STEP = 1e-3
"""Change of the logarithm of E or ρ in a central difference of matrices that are all but linear in it."""


def modes_at(model: UpdatedModel, *, speed: float) -> Modes:
    """Oscillating modes of the updated model at a spin speed [rad/s], in the machine's sense of rotation."""
    return modes(_matrices(model, speed), spin=model.machine.direction * speed)


def eigenvalue_slopes_by_coordinate(model: UpdatedModel, found: Modes, *, speed: float) -> Complexes:
    """Derivatives (modes, n) [rad/s] of the eigenvalues at a spin speed [rad/s] by the model's coordinates."""
    coordinates = model.coordinates_at(np.array([speed]))
    by_coefficient = eigenvalue_slopes(model.machine, found)
    slopes = np.zeros((found.eigenvalue.size, model.values.size), dtype=complex)
    for k, places in coefficient_slopes(coordinates, model.coefficients(speed)[None, :]).items():
        for place, by_coordinate in places.items():
            slopes[:, place] += by_coefficient[:, k] * by_coordinate[0]
    for place in map(int, coordinates.scale_place):
        step = np.zeros(model.values.size)
        step[place] = SCALE_STEP
        ahead, behind = (_matrices(replace(model, values=model.values + sign * step), speed) for sign in (1, -1))
        spin = model.machine.direction * speed
        for mode, root in enumerate(found.eigenvalue):
            change = ahead.dynamic_stiffness(root, spin=spin) - behind.dynamic_stiffness(root, spin=spin)
            slopes[mode, place] = -np.vdot(found.left[:, mode], change @ found.shape[:, mode]) / (2 * SCALE_STEP)
    return slopes


def natural_frequency_errors(model: UpdatedModel, found: Modes, *, speed: float) -> Floats:
    """Standard errors (modes,) [rad/s] of the damped natural frequencies."""
    return standard_errors(eigenvalue_slopes_by_coordinate(model, found, speed=speed).imag, model.covariance)


def critical_speed_errors(model: UpdatedModel, table: tuple[CriticalSpeed, ...]) -> Floats:
    """Standard errors [rad/s] of the model's critical speeds.

    From Im λ(Ω, p) = Ω: dΩ = Im ∂λ/∂p dp / (1 - Im ∂λ/∂Ω).
    """
    errors = []
    for one in table:
        found = modes_at(model, speed=one.speed)
        mode = int(np.argmin(np.abs(found.eigenvalue - one.eigenvalue)))
        only = Modes(found.eigenvalue[[mode]], found.shape[:, [mode]], found.left[:, [mode]])
        slope = eigenvalue_slopes_by_coordinate(model, only, speed=one.speed).imag[0]
        errors.append(float(standard_errors(slope, model.covariance)) / abs(1.0 - _by_speed(model, only, one.speed)))
    return np.array(errors)


def _by_speed(model: UpdatedModel, found: Modes, speed: float) -> float:
    """Im ∂λ/∂Ω of one mode, by a central difference: coefficients may follow the speed in any way."""
    step, root, direction = 1e-4 * speed, complex(found.eigenvalue[0]), model.machine.direction
    ahead, behind = (_matrices(model, at).dynamic_stiffness(root, spin=direction * at) for at in (speed + step, speed - step))
    return float(-np.vdot(found.left[:, 0], (ahead - behind) @ found.shape[:, 0]).imag / (2 * step))


def _matrices(model: UpdatedModel, speed: float) -> SystemMatrices:
    return system_matrices(model.scaled_machine, coefficients=model.coefficients(speed))
