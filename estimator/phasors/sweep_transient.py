"""Effect of a sweep's rate on the 1× phasors: their deviation from the steady state, from a train's modes and the speed.

Each mode k of the train, in the frame that turns with the shaft, obeys ẇ = (λ_k - jω) w + yᴴF with its eigenvalue λ_k, left
vector y and the force F(ω, α) e^{jφ}; eigenvalue, vectors and shape are its own at each speed, and what their change with the
speed brings from other modes is neglected. At constant speed w = yᴴF / (jω - λ_k). After a resonance was crossed quickly, w
goes on ringing at the natural frequency while the 1× has moved on: the phasor beats. The difference of the integrated w from
the steady one, seen at the probes through the mode's shape, is the part of a measured phasor that must not be blamed on the
machine.
"""

from collections.abc import Callable

import numpy as np
import scipy
from msgspec import Struct
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.machine.document import Machine
from estimator.modes.eigenmodes import Modes
from estimator.modes.mode_tracks import ModeTracks, mode_tracks
from estimator.phasors.modal_transient import Sweep, modal_course
from estimator.phasors.speed_law import SpeedLaw
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.condensation import probe_rows
from estimator.rotor.modal_reduction import modal_basis
from estimator.rotor.parameters import unknowns
from estimator.rotor.synchronous_force import SynchronousForce, synchronous_force
from estimator.rotor.system_matrices import SystemMatrices, system_matrices_over_speed

STEP_ANGLE = 0.02
"""Largest α h² of a step [rad]: the angle by which the speed turns the phasor within the step beyond its mean."""
LARGEST_STEPS = 20_000
"""Most steps of a whole run."""
HIGHEST_MODE = 1.5
"""Highest frequency of the modes that take part, as a multiple of the highest speed [-]; those above follow without delay."""
SPIN_STEP = 1e-3
"""Relative change of the spin speed by which eigenvalues are differentiated [-]."""
FOLLOWED_SPEEDS = 13
"""Number of speeds at which modes are solved for where coefficients follow the speed."""


class SweepTransient(Struct, frozen=True, eq=False):
    """Measured minus steady-state phasors that a train predicts for a sweep.

    Attributes:
        instant: Deviations (S, m) of phasors that are taken at an instant [m].
        averaged: Deviations (S, m) of phasors that are means over the time from halfway after the sample before to halfway to
            the next, as the blocks of a tracking filter are [m].
    """

    instant: Complexes
    averaged: Complexes


class SweptTrain(Struct, frozen=True, eq=False):
    """A train whose parameters are known, as a sweep moves it.

    Attributes:
        machine: The machine, with E and density as they are.
        coefficients: Gives the coefficients (K,) [SI] at a spin speed [rad/s, without sign].
        follows_speed: Whether these follow the speed.
        excitations: Excitations (E,), the unbalances first [SI].
    """

    machine: Machine
    coefficients: Callable[[float], Floats]
    follows_speed: bool
    excitations: Complexes


def sweep_transient(train: SweptTrain, *, time: Floats, speed: Floats) -> SweepTransient:
    """Predict the deviations of phasors from the steady state for a sweep in the machine's sense of rotation.

    Before the first sample the speed is taken to have changed slowly. Modes that are undamped or grow are left out: they have
    no steady state to deviate from.

    Args:
        train: The train.
        time: Times (S,), ascending [s].
        speed: Speeds (S,), as measured [rad/s].

    Returns:
        Deviations at S samples and m probes.
    """
    law = SpeedLaw.measured(time, speed)
    grid, place = _grid(law, time)
    sweep = Sweep.along(law, grid)
    machine = train.machine
    basis = modal_basis(machine, HIGHEST_MODE * float(speed.max()))
    matrices = system_matrices_over_speed(machine, coefficients=train.coefficients, basis=basis)
    tracks = _followed(matrices, train, speed)
    rotor = assemble_rotor(machine)
    force = synchronous_force(
        rotor,
        unknowns(machine, rotor),
        values=train.excitations,
        coefficients=lambda: train.coefficients(float(np.median(speed))),
        direction=machine.direction,
    )
    modal = [force.project(basis.expanded(one.left).conj().T) for one in tracks.modes]
    over = _Interpolation(tracks.speed, sweep.speed)
    eigenvalue = over(tracks.eigenvalue)
    if tracks.speed.size == 1:
        away = sweep.speed - tracks.speed[0]
        eigenvalue += away[:, None] * _eigenvalue_drift(
            matrices, tracks.modes[0], spin=tracks.speed[0], direction=machine.direction
        )
    along = SynchronousForce(over(np.stack([one.squared for one in modal])), over(np.stack([one.constant for one in modal])))
    pushed, resting = along.at(sweep.speed, sweep.acceleration), along.at(sweep.speed)
    output = probe_rows(machine, rotor)
    seen = over(np.stack([output @ basis.expanded(one.shape) for one in tracks.modes]), place)
    instant, averaged = (np.zeros((time.size, len(output)), dtype=complex) for _ in range(2))
    # A mode that is damped at the middle of the sweep may grow at an end of it.
    for k in np.flatnonzero(eigenvalue.real.max(axis=0, initial=-np.inf) < 0.0).tolist():
        course = modal_course(sweep, eigenvalue[:, k], pushed[:, k], resting[:, k])
        instant += course.deviation[place, None] * seen[:, :, k]
        averaged += (course.mean(place) - course.rest[place])[:, None] * seen[:, :, k]
    return SweepTransient(instant, averaged)


def _followed(matrices: Callable[[float], SystemMatrices], train: SweptTrain, speed: Floats) -> ModeTracks:
    """Follow the modes that take part over the speeds of a sweep; where gyroscopic moments alone change them, not at all."""
    low, high = float(speed.min()), float(speed.max())
    follows = high > low and train.follows_speed
    speeds = np.linspace(low, high, FOLLOWED_SPEEDS) if follows else np.array([float(np.median(speed))])
    tracks = mode_tracks(matrices, speeds, direction=train.machine.direction, highest=HIGHEST_MODE * high)
    return tracks.pick(tracks.eigenvalue.real.max(axis=0) < 0.0)


def _eigenvalue_drift(matrices: Callable[[float], SystemMatrices], found: Modes, *, spin: float, direction: int) -> Complexes:
    """Compute dλ/dω (n,) of each mode: -yᴴ (∂Z/∂ω) x."""
    drift = np.empty(found.eigenvalue.size, dtype=complex)
    other = spin * (1.0 + SPIN_STEP)
    here, there = matrices(spin), matrices(other)
    for k, value in enumerate(found.eigenvalue):
        change = there.dynamic_stiffness(value, spin=direction * other) - here.dynamic_stiffness(value, spin=direction * spin)
        drift[k] = -np.vdot(found.left[:, k], change @ found.shape[:, k]) / (other - spin)
    return drift


class _Interpolation:
    """Interpolation of what is known at G speeds by cubic splines, at the speeds along a sweep."""

    def __init__(self, known: Floats, wanted: Floats) -> None:
        self.known = known
        self.wanted = np.clip(wanted, known[0], known[-1])

    def __call__(self, values: Complexes, place: NDArray[np.intp] | None = None) -> Complexes:
        """Return the values (G, ...) at all speeds wanted, or at some of them."""
        wanted = self.wanted if place is None else self.wanted[place]
        if self.known.size == 1:
            return np.repeat(values, wanted.size, axis=0)
        return np.asarray(scipy.interpolate.CubicSpline(self.known, values)(wanted))


def _grid(law: SpeedLaw, time: Floats) -> tuple[Floats, NDArray[np.intp]]:
    """Choose instants fine enough to follow the phase, with one halfway between two samples, and find the samples
    among them."""
    step = np.sqrt(STEP_ANGLE / max(float(np.max(np.abs(law.acceleration(time)))), 1e-12))
    step = max(step, (time[-1] - time[0]) / LARGEST_STEPS)
    pieces = 2 * np.maximum(1, np.ceil(np.diff(time) / (2 * step) - 1e-9)).astype(np.intp)
    place = np.concatenate([[0], np.cumsum(pieces)])
    return np.interp(np.arange(place[-1] + 1), place, time), place
