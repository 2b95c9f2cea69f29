"""Exact dynamic condensation of a train to the degrees of freedom that carry unknowns or probes.

At each speed everything else is eliminated by the complex Schur complement, once per data set, so that the unknowns sit in
a small system Z(ω, p) q = F(ω, U) without any approximation. (The thesis's Eq. 4.8-4.20 condense the same way; its
high-frequency form of §4.4 drops the stiffness and is not used here.)
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimator.machine import Machine
from estimator.parameters import Unknowns, dense, unknowns
from estimator.rotor import Rotor, assemble_rotor
from estimator.shaft import NODE_DOFS

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]


@dataclass(frozen=True)
class CondensedTrain:
    """A train at S speeds, with n retained degrees of freedom, K coefficients, P unbalance planes and m channels.

    speed: (S,) spin speed [rad/s], positive. direction: (S,) +1 or -1.
    known: (S, n, n) dynamic stiffness of shafts and discs [N/m, N, N m/rad].
    force: (S, n, 2P) force per real and imaginary part of each unbalance [N/(kg m)].
    left, right: (n, K) vectors a, b of each coefficient; damping: (K,) True where it acts on the velocity.
    output: (m, n) displacement at each probe, along its angle.
    unknowns: names and expectations of the coefficients and unbalances, in the columns' order.
    channels: the m channel ids.
    """

    speed: Floats
    direction: Floats
    known: Complexes
    force: Complexes
    left: Floats
    right: Floats
    damping: NDArray[np.bool_]
    output: Floats
    unknowns: Unknowns
    channels: tuple[str, ...]

    def dynamic_stiffness(self, coefficients: Floats) -> Complexes:
        """Z = known + Σ p a bᵀ (1 or jω), shape (S, n, n), for coefficients (K,)."""
        elastic = (self.left[:, ~self.damping] * coefficients[~self.damping]) @ self.right[:, ~self.damping].T
        viscous = (self.left[:, self.damping] * coefficients[self.damping]) @ self.right[:, self.damping].T
        return np.asarray(self.known + elastic + 1j * self.speed[:, None, None] * viscous)


class SingularCondensation(ValueError):
    """A speed falls on a natural frequency of the part that is eliminated."""


def condense(machine: Machine, *, speed: Floats, direction: Floats) -> CondensedTrain:
    """Condense a machine at the given speeds.

    speed: (S,) [rad/s], positive and finite. direction: (S,) +1 for rotation from +x to +y, -1 against it.
    Raises ValueError for speeds that are not positive, SingularCondensation where elimination is impossible.
    """
    speed = np.asarray(speed, dtype=float)
    direction = np.asarray(direction, dtype=float)
    if speed.ndim != 1 or speed.size == 0 or not np.all(np.isfinite(speed) & (speed > 0)):
        raise ValueError("speed must be a non-empty list of positive, finite spin speeds [rad/s]")
    if direction.shape != speed.shape or not np.all(np.abs(direction) == 1):
        raise ValueError("direction must hold +1 or -1 for each speed")
    rotor = assemble_rotor(machine)
    unknown = unknowns(machine, rotor)
    output = _probe_rows(machine, rotor)
    left = dense([c.left for c in unknown.coefficients], rotor.size)
    right = dense([c.right for c in unknown.coefficients], rotor.size)
    retained = np.flatnonzero(np.any(left, axis=1) | np.any(right, axis=1) | np.any(output, axis=0))
    known, force = _schur(rotor, unknown, retained, speed, direction)
    return CondensedTrain(
        speed=speed,
        direction=direction,
        known=known,
        force=force,
        left=left[retained],
        right=right[retained],
        damping=np.array([c.quantity == "damping" for c in unknown.coefficients]),
        output=output[:, retained],
        unknowns=unknown,
        channels=machine.channels,
    )


def _probe_rows(machine: Machine, rotor: Rotor) -> Floats:
    rows = np.zeros((len(machine.probes), rotor.size))
    for row, probe in zip(rows, machine.probes, strict=True):
        x = NODE_DOFS * rotor.node(probe.shaft, probe.station)
        angle = np.deg2rad(probe.angle_deg)
        row[x], row[x + 1] = np.cos(angle), np.sin(angle)
        row[np.abs(row) < 1e-15] = 0.0  # a probe along an axis sees that axis only
    return rows


def _schur(
    rotor: Rotor, unknown: Unknowns, retained: NDArray[np.intp], speed: Floats, direction: Floats
) -> tuple[Complexes, Complexes]:
    eliminated = np.setdiff1d(np.arange(rotor.size), retained)
    known = np.empty((speed.size, retained.size, retained.size), dtype=complex)
    force = np.empty((speed.size, retained.size, 2 * len(unknown.unbalances)), dtype=complex)
    for i, (omega, sense) in enumerate(zip(speed, direction, strict=True)):
        stiffness = rotor.stiffness - omega**2 * rotor.mass + 1j * omega * (sense * omega) * rotor.gyroscopic
        full_force = _unbalance_force(rotor, unknown, omega, sense)
        inner = stiffness[np.ix_(eliminated, eliminated)]
        across = np.hstack([stiffness[np.ix_(eliminated, retained)], full_force[eliminated]])
        try:
            solved = np.linalg.solve(inner, across)
        except np.linalg.LinAlgError:
            raise SingularCondensation(
                f"speed {omega:.6g} rad/s falls on a natural frequency of the shafts clamped at bearings and couplings: "
                "leave that speed out"
            ) from None
        outer = stiffness[np.ix_(retained, eliminated)]
        known[i] = stiffness[np.ix_(retained, retained)] - outer @ solved[:, : retained.size]
        force[i] = full_force[retained] - outer @ solved[:, retained.size :]
    return known, force


def _unbalance_force(rotor: Rotor, unknown: Unknowns, omega: float, sense: float) -> Complexes:
    """Force columns (N, 2P): ω² U (1, -j) for rotation from +x to +y; its mirror image, with U conjugate, against it."""
    force = np.zeros((rotor.size, 2 * len(unknown.unbalances)), dtype=complex)
    for plane, item in enumerate(unknown.unbalances):
        x = NODE_DOFS * item.node
        force[x, 2 * plane], force[x + 1, 2 * plane] = omega**2, -1j * sense * omega**2
        force[x, 2 * plane + 1], force[x + 1, 2 * plane + 1] = 1j * sense * omega**2, omega**2
    return force
