"""The problem of a fit, which is data, train and coordinates, with its weighted residuals and derivatives; and the result."""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.fit.coordinates import Coordinates
from estimator.fit.phasor_jacobian import phasor_jacobian
from estimator.machine.rules import Noise
from estimator.phasors.measurement import Measurement
from estimator.phasors.noise import error_size
from estimator.rotor.condensation import CondensedTrain
from estimator.rotor.response import response, sensitivity

SMALLEST_AMPLITUDE = 0.01
"""Least amplitude of a channel as a part of the sample's largest, for the weights before there is a fit [-]."""


@dataclass(frozen=True)
class FitResult:
    """End of a fit from one start.

    Attributes:
        theta: Fit coordinates θ (n,) [-].
        chi_square: χ² of the data at the final weights [-].
        information: Fisher information (n, n) of the data in the coordinates [-].
        converged: Whether the last stage met its tolerance.
        iterations: Number of steps tried.
        noise: Noise model used at the end.
        outlier: True for phasors left out (S, m).
        misfit: Measure by which starts are compared [-]: χ² with the cost of the outliers; where the noise is estimated, times
            the mean size of its variance; infinite where the start was given up.
        channel_noise: Noise of each channel over the noise model's, (m,) or (1,) [-].
        coarse_misfit: χ²/dof after the stages that allow a relative misfit [-]; NaN where there were none.
    """

    theta: Floats
    chi_square: float
    information: Floats
    converged: bool
    iterations: int
    noise: Noise
    outlier: NDArray[np.bool_]
    misfit: float
    channel_noise: Floats
    coarse_misfit: float = math.nan


@dataclass(frozen=True)
class FitProblem:
    """One data set, one train, one set of coordinates.

    Attributes:
        train: The condensed train.
        measurement: Measured phasors at the train's S speeds.
        coordinates: Coordinates of the fit.
        noise: Noise model.
        outlier: True for phasors left out (S, m).
        robust: Whether outliers are left out at all.
        channel_noise: Noise of each channel over the noise model's, (m,) or (1,) [-].
    """

    train: CondensedTrain
    measurement: Measurement
    coordinates: Coordinates
    noise: Noise
    outlier: NDArray[np.bool_]
    robust: bool = True
    channel_noise: Floats = field(default_factory=lambda: np.ones(1))
    _scaled: dict[bytes, CondensedTrain] = field(default_factory=dict)

    @property
    def used(self) -> NDArray[np.bool_]:
        """Return which phasors count (S, m)."""
        return self.measurement.usable & ~self.outlier

    @property
    def first_amplitude(self) -> Floats:
        """Return the amplitudes (S, m) to weigh with before there is a fit [m].

        A dead channel must not pass for a precise one.
        """
        amplitude = np.abs(self.measurement.phasor)
        return np.asarray(np.maximum(amplitude, SMALLEST_AMPLITUDE * amplitude.max(axis=1, keepdims=True)))

    def scaled_train(self, theta: Floats) -> CondensedTrain:
        """Return the train with the scale factors of θ; the last two are cached.

        Args:
            theta: Fit coordinates θ (n,) [-].

        Returns:
            The scaled train.
        """
        if self.coordinates.scale_place.size == 0:
            return self.train
        factors = self.coordinates.scales(theta)
        key = factors.tobytes()
        if key not in self._scaled:
            while len(self._scaled) >= 2:
                self._scaled.pop(next(iter(self._scaled)))
            self._scaled[key] = self.train.scaled(factors)
        return self._scaled[key]

    def excitations(self, theta: Floats) -> Complexes:
        """Compute the excitations at θ, with known unbalances that were added.

        Args:
            theta: Fit coordinates θ (n,) [-].

        Returns:
            Excitations (E,), or (S, E) where known unbalances were added to some samples [SI].
        """
        own = self.coordinates.excitations(theta)
        added = self.measurement.added
        if added is None:
            return own
        whole = np.tile(own, (len(added), 1))
        whole[:, : added.shape[1]] += added
        return whole

    def model(self, theta: Floats) -> Complexes:
        """Compute the phasors that the channels should show at θ.

        Args:
            theta: Fit coordinates θ (n,) [-].

        Returns:
            Phasors (S, m) [m].
        """
        phasor = response(
            self.scaled_train(theta),
            coefficients=self.coordinates.coefficients(theta),
            excitations=self.excitations(theta),
        )
        return self.coordinates.channels.as_measured(theta, phasor, self.measurement.direction)

    def linearised(self, theta: Floats, weight: Floats) -> tuple[float, Floats, Floats]:
        """Linearise the problem at θ.

        Args:
            theta: Fit coordinates θ (n,) [-].
            weight: Weights (S, m) [1/m].

        Returns:
            χ² of the data [-], -½ of its gradient (n,) [-] and its Gauss-Newton curvature (n, n) [-].
        """
        train = self.scaled_train(theta)
        coefficients, excitations = self.coordinates.coefficients(theta), self.excitations(theta)
        weight = np.where(self.used, weight, 0.0)
        chi_square, gradient = 0.0, np.zeros(theta.size)
        curvature = np.zeros((theta.size, theta.size))
        for block in train.blocks():
            found = sensitivity(
                train.pick(block),
                coefficients=coefficients if coefficients.ndim == 1 else coefficients[block],
                excitations=excitations if excitations.ndim == 1 else excitations[block],
            )
            direction = self.measurement.direction[block]
            modelled = self.coordinates.channels.as_measured(theta, found.phasor, direction)
            residual = (self.measurement.phasor[block] - modelled) * weight[block]
            slope = phasor_jacobian(
                self.coordinates, theta, found, coefficients=coefficients, direction=direction, block=block
            )
            slope *= weight[block]
            # Real and imaginary parts side by side: the same sums at a quarter of the work.
            rows = slope.reshape(theta.size, -1).view(float)
            parts = residual.reshape(-1).view(float)
            chi_square += float(parts @ parts)
            gradient += rows @ parts
            curvature += rows @ rows.T
        return chi_square, gradient, curvature

    def chi_square(self, theta: Floats, weight: Floats) -> float:
        """Compute χ²: the sum of squared weighted residuals, real and imaginary parts counted apart.

        Args:
            theta: Fit coordinates θ (n,) [-].
            weight: Weights (S, m) [1/m].

        Returns:
            χ² [-].
        """
        residual = ((self.measurement.phasor - self.model(theta)) * weight)[self.used]
        return float(np.vdot(residual, residual).real)

    def error(self, amplitude: Floats) -> Floats:
        """Compute the rms of the complex error of phasors.

        Args:
            amplitude: Amplitude of the phasors (S, m) [m].

        Returns:
            Rms error (S, m) [m].
        """
        scatter = self.measurement.scatter
        return error_size(self.noise, amplitude, scatter) * np.where(scatter > 0.0, 1.0, self.channel_noise)

    def weight(self, amplitude: Floats, misfit: float) -> Floats:
        """Compute the weights of phasors: one over the error of each real part, with a relative misfit allowed beside it.

        Args:
            amplitude: Amplitude of the phasors (S, m) [m].
            misfit: Relative misfit [-].

        Returns:
            Weights (S, m) [1/m]; 0 where the error is zero and so unknown.
        """
        error = self.error(amplitude)
        whole = np.sqrt(error**2 + (misfit * amplitude) ** 2)
        # A response of exactly zero under a noise without floor: its error is unknown, so it does not count.
        return np.divide(np.sqrt(2.0), whole, out=np.zeros_like(whole), where=whole > 0.0)

    def best_excitations(self, theta: Floats, weight: Floats) -> Floats:
        """Solve for the excitations that fit best while everything else stays: a linear problem.

        Args:
            theta: Fit coordinates θ (n,) [-].
            weight: Weights (S, m) [1/m].

        Returns:
            θ (n,) with these unbalances, bows and loads [-].
        """
        first = self.coordinates.excitation_place
        free = np.concatenate([first[first >= 0], first[first >= 0] + 1])
        if free.size == 0:
            return theta
        _, gradient, curvature = self.linearised(theta, weight)
        block = curvature[np.ix_(free, free)] + self.coordinates.prior.precision[np.ix_(free, free)]
        # At the given excitations the model is linear in them: one Newton step is the answer.
        offset = self.coordinates.prior.pull(theta)[free]
        result = theta.copy()
        result[free] += np.linalg.solve(block, gradient[free] - offset)
        return result
