"""Phasors of a train with their derivatives by the coordinates of a fit, and the memory of the last ones.

A fit asks for the same ones again and again: with sharper weights, without outliers, for its end and for what is told of it.
"""

import numpy as np
from msgspec import Struct, field

from estimator.arrays import Complexes, Floats
from estimator.fit.problem.coordinates import Coordinates
from estimator.fit.problem.phasor_jacobian import phasor_jacobian
from estimator.phasors.measurement import Measurement
from estimator.rotor.condensation import CondensedTrain
from estimator.rotor.response import Sensitivity, sensitivity

Sources = tuple[Coordinates, CondensedTrain, Measurement]
"""Coordinates, train without scale factors and samples, of which phasors are computed."""


class LinearPhasors(Struct, frozen=True, eq=False):
    """Phasors of m channels at s of the speeds of a fit, with their derivatives.

    Attributes:
        block: The s speeds, among all of the fit.
        sensitivity: Phasors at the probes and their derivatives by physical parameters.
        phasor: Phasors (s, m) as the channels show them [m].
        jacobian: Their derivatives (n, s, m) by the coordinates [m].
    """

    block: slice
    sensitivity: Sensitivity
    phasor: Complexes
    jacobian: Complexes

    def weighted(self, measured: Complexes, weight: Floats) -> tuple[Floats, Floats]:
        """Return weighted derivatives and residuals, real and imaginary parts side by side.

        Args:
            measured: Measured phasors (S, m) at all speeds [m].
            weight: Weights (S, m) at all speeds [1/m].

        Returns:
            Derivatives (n, 2sm) and residuals (2sm,), measured less modelled [-].
        """
        own = weight[self.block]
        residual = (measured[self.block] - self.phasor) * own
        # Real and imaginary parts side by side: the same sums at a quarter of the work.
        rows = (self.jacobian * own).reshape(len(self.jacobian), -1).view(float)
        return rows, residual.reshape(-1).view(float)

    def extended(self, coordinates: Coordinates, direction: Floats) -> "LinearPhasors":
        """Return the same phasors with the derivatives by more coordinates of channels, which are zero.

        Args:
            coordinates: The coordinates, those of `jacobian` first.
            direction: Sense of rotation (S,) at all speeds, +1 or -1 [-].

        Returns:
            Phasors and derivatives by all coordinates.
        """
        more = coordinates.size - len(self.jacobian)
        whole = np.concatenate([self.jacobian, np.zeros((more, *self.phasor.shape), dtype=complex)])
        coordinates.channels.add_derivatives(whole, self.sensitivity.phasor, direction[self.block])
        return LinearPhasors(self.block, self.sensitivity, self.phasor, whole)


def linear_phasors(
    train: CondensedTrain,
    coordinates: Coordinates,
    theta: Floats,
    *,
    excitations: Complexes,
    direction: Floats,
    block: slice,
) -> LinearPhasors:
    """Compute phasors and their derivatives at some of the speeds.

    Args:
        train: The condensed train at all S speeds, with the scale factors of θ.
        coordinates: Coordinates of the fit.
        theta: Fit coordinates θ (n,) [-].
        excitations: Excitations at θ, (E,) or (S, E) [SI].
        direction: Sense of rotation (S,), +1 or -1 [-].
        block: The s speeds.

    Returns:
        Phasors and derivatives.
    """
    coefficients = coordinates.coefficients(theta)
    found = sensitivity(
        train.pick(block),
        coefficients=coefficients if coefficients.ndim == 1 else coefficients[block],
        excitations=excitations if excitations.ndim == 1 else excitations[block],
    )
    phasor = coordinates.channels.as_measured(theta, found.phasor, direction[block])
    jacobian = phasor_jacobian(coordinates, theta, found, coefficients=coefficients, direction=direction[block], block=block)
    return LinearPhasors(block, found, phasor, jacobian)


class PhasorMemory(Struct, eq=False):
    """Memory of the last phasors of a fit and of the last two with derivatives: by what they were computed of, and θ."""

    _phasors: "tuple[_PhasorKey, Complexes] | None" = None
    _linear: "list[tuple[_PhasorKey, LinearPhasors]]" = field(default_factory=list)

    def phasors(self, of: Sources, theta: Floats) -> Complexes | None:
        """Return the phasors at θ where they are known.

        Args:
            of: What they are computed of.
            theta: Fit coordinates θ (n,) [-].

        Returns:
            Phasors (S, m) [m], or None.
        """
        linear, known = self.linear(of, theta), self._phasors
        if linear is not None:
            return linear.phasor
        return known[1] if known is not None and known[0].equals(of, theta) else None

    def linear(self, of: Sources, theta: Floats) -> LinearPhasors | None:
        """Return the phasors at all speeds with their derivatives at θ where they are known.

        Args:
            of: What they are computed of.
            theta: Fit coordinates θ (n,) [-].

        Returns:
            Phasors and derivatives, or None.
        """
        return next((found for key, found in self._linear if key.equals(of, theta)), None)

    def keep_phasors(self, of: Sources, theta: Floats, found: Complexes) -> None:
        """Keep phasors.

        Args:
            of: What they are computed of.
            theta: Fit coordinates θ (n,) [-].
            found: Phasors (S, m) at all speeds [m].
        """
        self._phasors = _PhasorKey(of, theta.copy()), found

    def keep_linear(self, of: Sources, theta: Floats, found: LinearPhasors) -> None:
        """Keep phasors with their derivatives.

        Args:
            of: What they are computed of.
            theta: Fit coordinates θ (n,) [-].
            found: Phasors and derivatives at all speeds.
        """
        self._linear[:-1] = []  # a step that is not taken leads back to the last but one
        self._linear.append((_PhasorKey(of, theta.copy()), found))


class _PhasorKey(Struct, frozen=True):
    of: Sources
    theta: Floats

    def equals(self, of: Sources, theta: Floats) -> bool:
        """Return whether phasors are computed of the very same objects, which never change, at the same θ."""
        return all(one is other for one, other in zip(self.of, of, strict=True)) and np.array_equal(self.theta, theta)
