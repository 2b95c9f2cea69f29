"""The whole train in matrices, M q̈ + (C + Ω G) q̇ + K q = f: shafts, discs, bearings and couplings together."""

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from estimator.condensation import Complexes, Floats
from estimator.machine import Machine
from estimator.parameters import dense, unknowns
from estimator.rotor import assemble_rotor


@dataclass(frozen=True)
class SystemMatrices:
    """mass, damping, gyroscopic (per unit spin speed) and stiffness, each (N, N) in SI, order (x, y, θx, θy) per node."""

    mass: Floats
    damping: Floats
    gyroscopic: Floats
    stiffness: Floats

    def dynamic_stiffness(self, eigenvalue: complex, *, spin: float) -> Complexes:
        """K + λ (C + Ω G) + λ² M, (N, N), for a motion e^{λt} at a spin speed Ω [rad/s], signed as the sense of rotation."""
        return np.asarray(self.stiffness + eigenvalue * (self.damping + spin * self.gyroscopic) + eigenvalue**2 * self.mass)

    def state_matrix(self, *, spin: float) -> Floats:
        """A (2N, 2N) of ż = A z with z = (q, q̇), at a spin speed [rad/s]."""
        size = self.mass.shape[0]
        forces = np.hstack([self.stiffness, self.damping + spin * self.gyroscopic])
        inverse_mass = scipy.linalg.cho_solve(scipy.linalg.cho_factor(self.mass), forces)
        lower = np.hstack([-inverse_mass[:, :size], -inverse_mass[:, size:]])
        return np.asarray(np.vstack([np.hstack([np.zeros((size, size)), np.eye(size)]), lower]))


def system_matrices(machine: Machine, *, coefficients: Floats | None = None) -> SystemMatrices:
    """Matrices of a machine with coefficients (K,) in SI, by default what the document expects (thesis Eq. 3.1-3.11)."""
    rotor = assemble_rotor(machine)
    unknown = unknowns(machine, rotor)
    values = np.array([c.expected for c in unknown.coefficients]) if coefficients is None else np.asarray(coefficients)
    if values.shape != (len(unknown.coefficients),):
        raise ValueError(f"machine '{machine.id}' has {len(unknown.coefficients)} coefficients, not {values.shape}")
    left = dense([c.left for c in unknown.coefficients], rotor.size) * values
    right = dense([c.right for c in unknown.coefficients], rotor.size)
    viscous = np.array([c.quantity == "damping" for c in unknown.coefficients])
    return SystemMatrices(
        mass=rotor.mass,
        damping=left[:, viscous] @ right[:, viscous].T,
        gyroscopic=rotor.gyroscopic,
        stiffness=rotor.stiffness + left[:, ~viscous] @ right[:, ~viscous].T,
    )
