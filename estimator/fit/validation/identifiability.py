"""Reasons why the data leave a parameter open, in words an analyst can act on."""

from collections.abc import Callable
from functools import cached_property

import numpy as np
from msgspec import Struct

from estimator.arrays import Complexes, Floats
from estimator.fit.problem.coordinates import Coordinates
from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.machine.document import Machine
from estimator.machine.parameter_description import describe
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.modal_reduction import reduced_basis
from estimator.rotor.parameters import Coefficient, dense
from estimator.units import rad_per_s_to_rpm

SMALLEST_SHARE = 0.005
"""Part of a mode's energy that an element must hold, or take out in a radian, for the mode to move it [-]."""

MODES_ABOVE = 2.0
"""Multiple of the highest speed up to which the reduced mesh keeps its modes [-]; those above are only approximate."""

Reasons = Callable[[FitProblem, FitResult, Floats], Callable[[str], str]]
"""Function that, for a fit and the covariance of its coordinates, returns the function that says why a coordinate is left
open.
"""


class _Modes(Struct, frozen=True, eq=False):
    """Damped natural frequencies (M,) [rad/s] and, per coefficient, the share it has in each mode's energy (M, K)."""

    frequency: Floats
    share: Floats


class OpenParameters:
    """Reasons why a fit of a machine does not determine a coordinate."""

    def __init__(self, machine: Machine, problem: FitProblem, found: FitResult, covariance: Floats) -> None:
        self.machine = machine
        self.problem = problem
        self.found = found
        self.covariance = covariance

    def reason(self, name: str) -> str:
        """State why a coordinate is not determined.

        Source: own derivation: what the fit's covariance and the document say, in words.

        Args:
            name: Name of the coordinate.

        Returns:
            The reason in words.
        """
        place = self.problem.coordinates.names.index(name)
        coefficient = self._coefficient(place)
        if coefficient is not None:
            missing = self._no_mode(*coefficient)
            if missing:
                return missing
        return self._mistaken_for(place) or "the noise hides it: more samples near the resonances, or less noise, are needed"

    @property
    def _range(self) -> tuple[float, float]:
        speed = self.problem.measurement.speed
        return float(speed.min()), float(speed.max())

    def _coefficient(self, place: int) -> tuple[int, Coefficient] | None:
        coordinates, own = self.problem.coordinates, describe(self.problem.coordinates.names[place]).coefficient
        given = [(k, one) for k, one in enumerate(self.problem.train.unknowns.coefficients) if place in coordinates.places(k)]
        # Of the several coefficients of a model, the one that the coordinate is named after.
        return next((pair for pair in given if pair[1].name == own), given[0] if given else None)

    def _no_mode(self, k: int, coefficient: Coefficient) -> str | None:
        if not np.isfinite(self._values).all():
            return "where the fit ended a film carries no journal, so that the train has no modes there"
        low, high = self._range
        moved = self._modes.share[:, k] >= SMALLEST_SHARE
        frequency = self._modes.frequency
        if np.any(moved & (frequency >= low) & (frequency <= high)):
            return None
        covered = f"{rad_per_s_to_rpm(low):.0f}-{rad_per_s_to_rpm(high):.0f} r/min"
        words = f"the speed range {covered} crosses no mode that moves {coefficient.element.replace('.', ' ')}"
        beyond = frequency[moved & ((frequency < low) | (frequency > high))]
        if beyond.size == 0:
            return words
        nearest = beyond[np.argmin(np.minimum(np.abs(beyond - low), np.abs(beyond - high)))]
        return f"{words} this way; the nearest that does lies at {rad_per_s_to_rpm(nearest):.0f} r/min"

    def _mistaken_for(self, place: int) -> str | None:
        """Name the parameter whose effect is most like this one's, if this one alone would be determined much better."""
        size = np.sqrt(np.diag(self.covariance))
        alone = self.found.information[place, place] ** -0.5 if self.found.information[place, place] > 0.0 else np.inf
        if alone > 0.5 * size[place]:
            return None
        correlation = np.abs(self.covariance[place] / (size * size[place]))
        correlation[place] = 0.0
        other = int(np.argmax(correlation))
        return (
            f"what it does cannot be told from what others do, most of all {self.problem.coordinates.names[other]} "
            f"(correlation {correlation[other]:.2f}): a wider speed range, more probes or a fixed value there would help"
        )

    @cached_property
    def _values(self) -> Floats:
        """Return the fitted coefficients (K,) at the middle of the speed range [SI]; NaN where a film carries nothing."""
        coordinates: Coordinates = self.problem.coordinates
        values = coordinates.coefficients(self.found.theta)
        return values if values.ndim == 1 else values[values.shape[0] // 2]

    @cached_property
    def _modes(self) -> _Modes:
        """Compute the modes at the middle of the speed range, with the fitted coefficients."""
        values = self._values
        spin = self.machine.direction * float(np.mean(self._range))
        basis = reduced_basis(self.machine, MODES_ABOVE * self._range[1])
        whole = assemble_rotor(self.machine)
        rotor = basis.reduced(whole)
        coefficients = self.problem.train.unknowns.coefficients
        vectors = [[basis.project(dense(list(side), whole.size)) for side in zip(*c.pairs, strict=True)] for c in coefficients]
        matrices = [np.zeros((rotor.size, rotor.size)) for _ in range(3)]
        for c, value, (left, right) in zip(coefficients, values, vectors, strict=True):
            matrices[c.order] += value * left @ right.T
        stiffness = rotor.stiffness + spin * rotor.circulatory + matrices[0]
        damping = rotor.damping + spin * rotor.gyroscopic + matrices[1]
        inverse = np.linalg.inv(rotor.mass + matrices[2])
        empty, unit = np.zeros_like(stiffness), np.eye(rotor.size)
        roots, modes = np.linalg.eig(np.block([[empty, unit], [-inverse @ stiffness, -inverse @ damping]]))
        oscillating = roots.imag > 1e-6 * np.abs(roots)
        shape, frequency = modes[: rotor.size, oscillating], roots.imag[oscillating]
        energy = np.einsum("im,ij,jm->m", shape.conj(), rotor.mass, shape).real * frequency**2
        share = [
            np.abs(value) * frequency**c.order * np.abs(_work(left, right, shape)) / energy
            for c, value, (left, right) in zip(coefficients, values, vectors, strict=True)
        ]
        return _Modes(frequency, np.stack(share, axis=1))


def _work(left: Floats, right: Floats, shape: Complexes) -> Complexes:
    """Compute ψᴴ a bᵀ ψ summed over the pairs, (M,)."""
    return np.asarray(np.sum((left.T @ shape).conj() * (right.T @ shape), axis=0))


def reasons_for(machine: Machine) -> Reasons:
    """Return the function that says why a fit of a machine leaves a parameter open.

    Args:
        machine: The machine.

    Returns:
        Function of a fit and the covariance of its coordinates.
    """
    return lambda problem, found, covariance: OpenParameters(machine, problem, found, covariance).reason
