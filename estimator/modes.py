"""Damped natural frequencies of a train and its critical speeds."""

import numpy as np
import scipy.linalg
import scipy.optimize

from estimator.condensation import Complexes, Floats
from estimator.machine import Machine
from estimator.parameters import dense, unknowns
from estimator.rotor import Rotor, assemble_rotor

HEAVILY_DAMPED = 0.9
"""Damping ratio above which a crossing is no critical speed."""
CAMPBELL_STEPS = 24
"""Speeds at which the natural frequencies are sampled to bracket the critical speeds."""


def eigenvalues(machine: Machine, *, coefficients: Floats | None = None, spin: float = 0.0) -> Complexes:
    """Eigenvalues λ [rad/s] with positive imaginary part, by ascending imaginary part, at a spin speed [rad/s].

    coefficients: (K,) in SI, by default what the document expects; spin: signed as the sense of rotation. Im λ is the damped
    natural frequency, |λ| the undamped one, -Re λ / |λ| the damping ratio. Overdamped modes are left out.
    """
    rotor = assemble_rotor(machine)
    stiffness, damping = _with_elements(machine, rotor, coefficients)
    damping = damping + spin * rotor.gyroscopic
    inverse_mass = scipy.linalg.cho_solve(scipy.linalg.cho_factor(rotor.mass), np.hstack([stiffness, damping]))
    size = rotor.size
    state = np.block([[np.zeros((size, size)), np.eye(size)], [-inverse_mass[:, :size], -inverse_mass[:, size:]]])
    roots = np.linalg.eigvals(state)
    oscillating = roots[roots.imag > 1e-6 * np.abs(roots)]
    return np.asarray(oscillating[np.argsort(oscillating.imag)])


def natural_frequencies(machine: Machine, *, coefficients: Floats | None = None, spin: float = 0.0) -> Floats:
    """Damped natural frequencies [rad/s], ascending, of the train at a spin speed [rad/s]; see `eigenvalues`."""
    return np.asarray(eigenvalues(machine, coefficients=coefficients, spin=spin).imag)


def critical_speeds(machine: Machine, *, highest: float, coefficients: Floats | None = None) -> Floats:
    """Speeds up to `highest` [rad/s] at which a damped natural frequency equals the spin speed, ascending.

    The crossings of the Campbell diagram's curves with the synchronous line, both whirl directions counted. Modes so heavily
    damped that nothing is felt in passing are left out.
    """
    spins = np.linspace(1e-6 * highest, highest, CAMPBELL_STEPS + 1)
    curves = [natural_frequencies(machine, coefficients=coefficients, spin=machine.direction * spin) for spin in spins]
    count = min(len(curve) for curve in curves)
    above = np.array([curve[:count] for curve in curves]) - spins[:, None]
    found: list[float] = []
    for mode in range(count):

        def gap(spin: float, mode: int = mode) -> float:
            at = natural_frequencies(machine, coefficients=coefficients, spin=machine.direction * spin)
            return float(at[mode] - spin)

        for i in np.flatnonzero(np.sign(above[:-1, mode]) * np.sign(above[1:, mode]) < 0):
            spin = float(scipy.optimize.brentq(gap, spins[i], spins[i + 1], xtol=1e-6))
            root = eigenvalues(machine, coefficients=coefficients, spin=machine.direction * spin)[mode]
            if -root.real < HEAVILY_DAMPED * abs(root):
                found.append(spin)
    return np.sort(np.array(found))


def _with_elements(machine: Machine, rotor: Rotor, coefficients: Floats | None) -> tuple[Floats, Floats]:
    unknown = unknowns(machine, rotor)
    values = np.array([c.expected for c in unknown.coefficients]) if coefficients is None else coefficients
    left = dense([c.left for c in unknown.coefficients], rotor.size) * values
    right = dense([c.right for c in unknown.coefficients], rotor.size)
    viscous = np.array([c.quantity == "damping" for c in unknown.coefficients])
    stiffness = rotor.stiffness + left[:, ~viscous] @ right[:, ~viscous].T
    return stiffness, left[:, viscous] @ right[:, viscous].T
