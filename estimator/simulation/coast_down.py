"""A train that runs up or coasts down, integrated in time: what its probes see when nothing is in a steady state.

M q̈ + d/dt(Ω G q) + C q̇ + (K + Ω H) q = Re(F e^{jφ}) with the angle φ(t) of a given speed law, Ω = ±φ̇ and the force of
synchronous_force.py with its terms of acceleration. The motion is written as q = Re(Q(t) e^{jφ}) without any approximation:

    M Q̈ + (C + ΩG + 2jω M) Q̇ + (K + ΩH + Ω̇ G + jω (C + ΩG) + (jα - ω²) M) Q = F

which is integrated by the trapezoidal rule (Newmark's of average acceleration, J. Eng. Mech. Div. 85 (1959) 67,
doi:10.1061/JMCEA3.0000098). In the rotating frame a free vibration at the natural frequency ω_n turns with ω_n - ω only, which
a step must resolve.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from estimator.arrays import Complexes, Floats
from estimator.machine.document import Machine
from estimator.phasors.speed_law import SpeedLaw
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.coefficient_models import expected_coefficients
from estimator.rotor.condensation import probe_rows
from estimator.rotor.parameters import unknowns
from estimator.rotor.synchronous_force import synchronous_force
from estimator.rotor.system_matrices import CoefficientsOverSpeed, SystemMatrices, system_matrices_over_speed

BLOCK = 4096
"""Number of steps whose forces are computed at a time."""


@dataclass(frozen=True)
class CoastDown:
    """Envelopes of the motions Re(X e^{jφ}) at m probes.

    Attributes:
        law: Speed law φ(t).
        time: Instants (T,) of the law [s].
        phasor: Envelopes X (T, m) [m].
    """

    law: SpeedLaw
    time: Floats
    phasor: Complexes

    def envelope(self, time: Floats) -> Complexes:
        """Interpolate the envelopes by cubic splines between the steps.

        Source: standard result: cubic spline between the steps.

        Args:
            time: Instants (N,) [s].

        Returns:
            Envelopes X (N, m) [m].
        """
        return np.asarray(self._curve(time))

    @cached_property
    def _curve(self) -> "scipy.interpolate.CubicSpline[np.complex128]":
        return scipy.interpolate.CubicSpline(self.time, self.phasor)

    def waveforms(self, time: Floats) -> Floats:
        """Compute the displacement at the probes.

        Args:
            time: Instants (N,) [s].

        Returns:
            Displacement (m, N) [m].
        """
        turning = np.exp(1j * self.law.angle(time))
        return np.asarray((self.envelope(time) * turning[:, None]).real.T)


def coast_down(
    machine: Machine,
    law: SpeedLaw,
    *,
    step: float,
    coefficients: CoefficientsOverSpeed = None,
    excitations: Complexes | None = None,
) -> CoastDown:
    """Integrate a machine through a speed law, from the steady state of its first speed on.

    The trapezoidal rule (Newmark's of average acceleration) on the equation of the module's docstring.

    Args:
        machine: The machine.
        law: Speed law; its speed must stay positive.
        step: Largest step of time [s].
        coefficients: Coefficients (K,) [SI], or a function of the speed that returns them; None for the expected ones.
        excitations: Excitations (E,) [SI]; None for the expected ones.

    Returns:
        Envelopes at the machine's probes.

    Raises:
        ValueError: The step or a speed is not positive, or the number of excitations is not E.
    """
    if not step > 0.0:
        raise ValueError(f"step is {step} s, it must be positive")
    rotor = assemble_rotor(machine)
    unknown = unknowns(machine, rotor)
    listed = unknown.excitations
    values = np.array([one.nominal or 0.0 for one in listed]) if excitations is None else np.asarray(excitations)
    if values.shape != (len(listed),):
        raise ValueError(f"machine '{machine.id}' has {len(listed)} excitations, not {values.shape}")
    count = max(1, int(np.ceil((law.end - law.begin) / step)))
    time = np.linspace(law.begin, law.end, count + 1)
    if np.any(law.speed(time) <= 0.0):
        raise ValueError("the speed must be positive throughout")
    matrices = system_matrices_over_speed(machine, coefficients=coefficients)
    output = probe_rows(machine, rotor)

    def pulling() -> Floats:
        middle = np.array([np.mean(law.speed(time[[0, -1]]))])
        if coefficients is None:
            return np.asarray(expected_coefficients(unknown.coefficients, middle)[0])
        return coefficients(float(middle[0])) if callable(coefficients) else coefficients

    force = synchronous_force(rotor, unknown, values=values, coefficients=pulling, direction=machine.direction)
    phasor = np.empty((time.size, len(output)), dtype=complex)
    state: tuple[Complexes, Complexes] | None = None
    for first in range(0, time.size, BLOCK):
        # One instant of overlap: a step needs both of its ends.
        piece = slice(max(0, first - 1), min(first + BLOCK, time.size))
        speed, acceleration = law.speed(time[piece]), law.acceleration(time[piece])
        motion = _Motion(matrices, machine.direction, speed, acceleration, force.at(speed, acceleration))
        if state is None:
            state = motion.steady()
        moved, state = motion.integrate(state, float(time[1] - time[0]))
        phasor[piece] = moved @ output.T
    return CoastDown(law, time, phasor)


@dataclass(frozen=True)
class _Motion:
    """Equations in the rotating frame at n instants: speed, acceleration (n,), force (n, N)."""

    matrices: Callable[[float], SystemMatrices]
    direction: int
    speed: Floats
    acceleration: Floats
    force: Complexes

    def at(self, i: int) -> tuple[SystemMatrices, Complexes, Complexes]:
        """Return the matrices there, and those of Q̇ and of Q."""
        found = self.matrices(float(self.speed[i]))
        omega, alpha = self.speed[i], self.acceleration[i]
        resisting = found.damping + self.direction * omega * found.gyroscopic
        rate = resisting + 2j * omega * found.mass
        elastic = found.stiffness + self.direction * (omega * found.circulatory + alpha * found.gyroscopic)
        return found, rate, elastic + 1j * omega * resisting + (1j * alpha - omega**2) * found.mass

    def steady(self) -> tuple[Complexes, Complexes]:
        """Solve for Q and Q̇ = 0 of the steady state at the first instant, with the force of a steady speed."""
        found, _, _ = self.at(0)
        omega = self.speed[0]
        stiffness = found.dynamic_stiffness(1j * omega, spin=self.direction * omega)
        return np.asarray(np.linalg.solve(stiffness, self.force[0])), np.zeros_like(self.force[0])

    def integrate(self, state: tuple[Complexes, Complexes], step: float) -> tuple[Complexes, tuple[Complexes, Complexes]]:
        """Integrate Q (n, N) from the first instant on; return it with Q and Q̇ at the last instant."""
        motion, velocity = state
        moved = np.empty_like(self.force)
        moved[0] = motion
        _, rate, elastic = self.at(0)
        before = self.force[0] - rate @ velocity - elastic @ motion
        for i in range(1, len(self.force)):
            found, rate, elastic = self.at(i)
            inertia = found.mass / step
            reached = motion + step / 2 * velocity
            right = inertia @ velocity + (before + self.force[i] - elastic @ reached) / 2
            velocity = np.asarray(np.linalg.solve(inertia + rate / 2 + step / 4 * elastic, right), dtype=complex)
            motion = reached + step / 2 * velocity
            before = self.force[i] - rate @ velocity - elastic @ motion
            moved[i] = motion
        return moved, (motion, velocity)
