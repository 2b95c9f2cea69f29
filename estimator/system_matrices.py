"""The whole train in matrices, M q̈ + (C + Ω G) q̇ + (K + Ω H) q = f: shafts, discs, bearings, seals and couplings together."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.linalg

from estimator.condensation import Complexes, Floats
from estimator.machine import Machine
from estimator.parameters import dense, unknowns
from estimator.rotor import assemble_rotor

CoefficientsOverSpeed = Floats | Callable[[float], Floats] | None
"""Coefficients (K,) in SI, or what gives them at a spin speed [rad/s, without sign]; None: what the document expects."""


@dataclass(frozen=True)
class SystemMatrices:
    """Matrices (N, N) in SI, order (x, y, θx, θy) per node.

    mass, damping, stiffness; gyroscopic and circulatory (of the shafts' internal damping) per unit spin speed.
    """

    mass: Floats
    damping: Floats
    gyroscopic: Floats
    stiffness: Floats
    circulatory: Floats

    def dynamic_stiffness(self, eigenvalue: complex, *, spin: float) -> Complexes:
        """K + Ω H + λ (C + Ω G) + λ² M, (N, N), of a motion e^{λt} at a spin speed Ω [rad/s], signed as the rotation."""
        elastic = self.stiffness + spin * self.circulatory
        return np.asarray(elastic + eigenvalue * (self.damping + spin * self.gyroscopic) + eigenvalue**2 * self.mass)

    def state_matrix(self, *, spin: float) -> Floats:
        """A (2N, 2N) of ż = A z with z = (q, q̇), at a spin speed [rad/s]."""
        size = self.mass.shape[0]
        forces = np.hstack([self.stiffness + spin * self.circulatory, self.damping + spin * self.gyroscopic])
        inverse_mass = scipy.linalg.cho_solve(scipy.linalg.cho_factor(self.mass), forces)
        lower = np.hstack([-inverse_mass[:, :size], -inverse_mass[:, size:]])
        return np.asarray(np.vstack([np.hstack([np.zeros((size, size)), np.eye(size)]), lower]))


def system_matrices(machine: Machine, *, coefficients: Floats | None = None) -> SystemMatrices:
    """Matrices of a machine with coefficients (K,) in SI, by default what the document expects (thesis Eq. 3.1-3.11)."""
    return _builder(machine)(coefficients)


def system_matrices_over_speed(
    machine: Machine, *, coefficients: CoefficientsOverSpeed = None
) -> Callable[[float], SystemMatrices]:
    """What gives the matrices at a spin speed [rad/s, without sign]."""
    built = _builder(machine)
    if callable(coefficients):
        at = coefficients
        return lambda speed: built(at(speed))
    constant = built(coefficients)
    return lambda _: constant


def _builder(machine: Machine) -> Callable[[Floats | None], SystemMatrices]:
    rotor = assemble_rotor(machine)
    unknown = unknowns(machine, rotor).coefficients
    left = dense([left for one in unknown for left, _ in one.pairs], rotor.size)
    right = dense([right for one in unknown for _, right in one.pairs], rotor.size)
    owner = np.repeat(np.arange(len(unknown)), [len(one.pairs) for one in unknown])
    order = np.array([one.order for one in unknown])[owner]
    expected = np.array([one.expected for one in unknown])
    mass, damping, stiffness = rotor.mass, rotor.damping, rotor.stiffness
    gyroscopic, circulatory = rotor.gyroscopic, rotor.circulatory

    def built(coefficients: Floats | None) -> SystemMatrices:
        values = expected if coefficients is None else np.asarray(coefficients)
        if values.shape != expected.shape:
            raise ValueError(f"machine '{machine.id}' has {expected.size} coefficients, not {values.shape}")
        added = [(left[:, order == n] * values[owner[order == n]]) @ right[:, order == n].T for n in range(3)]
        return SystemMatrices(
            mass=mass + added[2],
            damping=damping + added[1],
            gyroscopic=gyroscopic,
            stiffness=stiffness + added[0],
            circulatory=circulatory,
        )

    return built
