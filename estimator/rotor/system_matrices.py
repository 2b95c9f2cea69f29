"""Matrices of the whole train, M q̈ + (C + Ω G) q̇ + (K + Ω H) q = f: shafts, discs, bearings, seals and couplings."""

from collections.abc import Callable
from functools import lru_cache

import numpy as np
import scipy
from msgspec import Struct

from estimator.arrays import Complexes, Floats
from estimator.machine.document import Machine
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.coefficient_models import expected_coefficients, expects_a_law, governing_models
from estimator.rotor.modal_reduction import EVERYTHING, Basis
from estimator.rotor.parameters import dense, unknowns

CoefficientsOverSpeed = Floats | Callable[[float], Floats] | None
"""Coefficients (K,) [SI], or a function that returns them at a spin speed [rad/s, without sign]; None for the expected
ones."""

CACHE_SIZE = 4
"""Number of matrices cached, by their coefficients: a train whose coefficients do not follow the speed has but one."""


class SystemMatrices(Struct, frozen=True, eq=False):
    """Matrices of a train over (x, y, θx, θy) per node, or over the coordinates of a basis, in the same order.

    Attributes:
        mass: Mass matrix M (N, N) [kg, kg m, kg m²].
        damping: Damping matrix C (N, N) [N s/m, N s, N m s].
        gyroscopic: Gyroscopic matrix G (N, N) per unit spin speed [kg, kg m, kg m²].
        stiffness: Stiffness matrix K (N, N) [N/m, N, N m].
        circulatory: Circulatory matrix H (N, N) of the shafts' internal damping per unit spin speed [N s/m, N s, N m s].
    """

    mass: Floats
    damping: Floats
    gyroscopic: Floats
    stiffness: Floats
    circulatory: Floats

    def dynamic_stiffness(self, eigenvalue: complex, *, spin: float) -> Complexes:
        """Compute K + Ω H + λ (C + Ω G) + λ² M of a motion e^{λt}.

        Args:
            eigenvalue: λ [rad/s].
            spin: Spin speed Ω, signed as the rotation [rad/s].

        Returns:
            Dynamic stiffness (N, N) [N/m, N, N m].
        """
        elastic = self.stiffness + spin * self.circulatory
        return np.asarray(elastic + eigenvalue * (self.damping + spin * self.gyroscopic) + eigenvalue**2 * self.mass)

    def project(self, shapes: Floats) -> "SystemMatrices":
        """Project the matrices on motions that are combinations of some shapes.

        Args:
            shapes: Shapes (N, n) [-].

        Returns:
            Matrices (n, n).
        """
        return SystemMatrices(*(shapes.T @ getattr(self, one) @ shapes for one in self.__struct_fields__))

    def state_matrix(self, *, spin: float) -> Floats:
        """Compute A of ż = A z with z = (q, q̇).

        Source: standard result: the module's equation of motion in first-order form.

        Args:
            spin: Spin speed Ω, signed as the rotation [rad/s].

        Returns:
            A (2N, 2N) [SI].
        """
        size = self.mass.shape[0]
        forces = np.hstack([self.stiffness + spin * self.circulatory, self.damping + spin * self.gyroscopic])
        inverse_mass = scipy.linalg.cho_solve(scipy.linalg.cho_factor(self.mass), forces)
        lower = np.hstack([-inverse_mass[:, :size], -inverse_mass[:, size:]])
        return np.asarray(np.vstack([np.hstack([np.zeros((size, size)), np.eye(size)]), lower]))


def system_matrices(machine: Machine, *, coefficients: Floats | None = None, basis: Basis = EVERYTHING) -> SystemMatrices:
    """Assemble the matrices of a machine (thesis Eq. 3.1-3.11).

    Args:
        machine: The machine.
        coefficients: Coefficients (K,) [SI]; None for the expected ones.
        basis: Basis of the coordinates, by default all degrees of freedom.

    Returns:
        The matrices.

    Raises:
        ValueError: The number of coefficients is not the machine's.
    """
    return _builder(machine, basis)(coefficients)


def system_matrices_over_speed(
    machine: Machine, *, coefficients: CoefficientsOverSpeed = None, basis: Basis = EVERYTHING
) -> Callable[[float], SystemMatrices]:
    """Return the function that assembles the matrices at a spin speed; as `system_matrices`.

    Args:
        machine: The machine.
        coefficients: Coefficients (K,) [SI], or a function of the speed that returns them; None for the expected ones.
        basis: Basis of the coordinates, by default all degrees of freedom.

    Returns:
        Function of the spin speed [rad/s, without sign].

    Raises:
        ValueError: The number of coefficients is not the machine's.
    """
    built = _builder(machine, basis)
    if coefficients is None:
        coefficients = _expected_over_speed(machine)
    if callable(coefficients):
        at = coefficients

        @lru_cache(maxsize=CACHE_SIZE)
        def known(values: bytes) -> SystemMatrices:
            return built(np.frombuffer(values))

        # What is called with the speed may be constant for all that.
        return lambda speed: known(np.ascontiguousarray(at(speed), dtype=float).tobytes())
    constant = built(coefficients)
    return lambda _: constant


def _expected_over_speed(machine: Machine) -> CoefficientsOverSpeed:
    """Return the function of the speed that the expected coefficients are; None where they are constant."""
    listed = unknowns(machine, assemble_rotor(machine)).coefficients
    if not any(expects_a_law(one.model) for one in governing_models(listed)):
        return None
    return lambda speed: expected_coefficients(listed, np.array([speed]))[0]


def _builder(machine: Machine, basis: Basis) -> Callable[[Floats | None], SystemMatrices]:
    whole = assemble_rotor(machine)
    unknown = unknowns(machine, whole).coefficients
    left = basis.project(dense([left for one in unknown for left, _ in one.pairs], whole.size))
    right = basis.project(dense([right for one in unknown for _, right in one.pairs], whole.size))
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
