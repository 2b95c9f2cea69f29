"""The whole train in matrices, M q̈ + (C + Ω G) q̇ + (K + Ω H) q = f: shafts, discs, bearings, seals and couplings together."""

from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import lru_cache

import numpy as np
import scipy.linalg

from estimator.arrays import Complexes, Floats
from estimator.machine import Machine
from estimator.modal_reduction import EVERYTHING, Basis
from estimator.parameters import dense, unknowns
from estimator.rotor import assemble_rotor

CoefficientsOverSpeed = Floats | Callable[[float], Floats] | None
"""Coefficients (K,) in SI, or what gives them at a spin speed [rad/s, without sign]; None: what the document expects."""

KEPT = 4
"""Matrices at hand, by their coefficients: a train whose coefficients do not follow the speed has but one."""


@dataclass(frozen=True)
class SystemMatrices:
    """Matrices (N, N) in SI, order (x, y, θx, θy) per node, or over the coordinates of a basis, in the same order.

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

    def over(self, shapes: Floats) -> "SystemMatrices":
        """The same for motions that are made of some shapes (N, n)."""
        return SystemMatrices(*(shapes.T @ getattr(self, one.name) @ shapes for one in fields(self)))

    def state_matrix(self, *, spin: float) -> Floats:
        """A (2N, 2N) of ż = A z with z = (q, q̇), at a spin speed [rad/s]."""
        size = self.mass.shape[0]
        forces = np.hstack([self.stiffness + spin * self.circulatory, self.damping + spin * self.gyroscopic])
        inverse_mass = scipy.linalg.cho_solve(scipy.linalg.cho_factor(self.mass), forces)
        lower = np.hstack([-inverse_mass[:, :size], -inverse_mass[:, size:]])
        return np.asarray(np.vstack([np.hstack([np.zeros((size, size)), np.eye(size)]), lower]))


def system_matrices(machine: Machine, *, coefficients: Floats | None = None, basis: Basis = EVERYTHING) -> SystemMatrices:
    """Matrices of a machine with coefficients (K,) in SI, by default what the document expects (thesis Eq. 3.1-3.11).

    basis: over the coordinates of which, by default all degrees of freedom.
    """
    return _builder(machine, basis)(coefficients)


def system_matrices_over_speed(
    machine: Machine, *, coefficients: CoefficientsOverSpeed = None, basis: Basis = EVERYTHING
) -> Callable[[float], SystemMatrices]:
    """What gives the matrices at a spin speed [rad/s, without sign]; as `system_matrices`."""
    built = _builder(machine, basis)
    if callable(coefficients):
        at = coefficients

        @lru_cache(maxsize=KEPT)
        def known(values: bytes) -> SystemMatrices:
            return built(np.frombuffer(values))

        # What is called with the speed may be constant for all that.
        return lambda speed: known(np.ascontiguousarray(at(speed), dtype=float).tobytes())
    constant = built(coefficients)
    return lambda _: constant


def _builder(machine: Machine, basis: Basis) -> Callable[[Floats | None], SystemMatrices]:
    whole = assemble_rotor(machine)
    unknown = unknowns(machine, whole).coefficients
    left = basis.onto(dense([left for one in unknown for left, _ in one.pairs], whole.size))
    right = basis.onto(dense([right for one in unknown for _, right in one.pairs], whole.size))
    owner = np.repeat(np.arange(len(unknown)), [len(one.pairs) for one in unknown])
    order = np.array([one.order for one in unknown])[owner]
    expected = np.array([one.expected for one in unknown])
    rotor = basis.reduced(whole)
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
