"""The problem of a fit, which is data, train and coordinates, with its weighted residuals and derivatives; and the result."""

import math
from collections.abc import Iterator
from functools import singledispatch

import numpy as np
from msgspec import Struct, field
from msgspec.structs import replace
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.fit.problem.coordinates import Coordinates
from estimator.fit.problem.gap_rows import GapRows, gap_cost, linearised_gaps
from estimator.fit.problem.linear_phasors import LinearPhasors, PhasorMemory, Sources, linear_phasors
from estimator.machine.rules import Noise
from estimator.phasors.measurement import Measurement
from estimator.phasors.noise import error_size
from estimator.rotor.condensation import CondensedTrain
from estimator.rotor.response import excitation_responses, response

LARGEST_KEPT = 1_000_000
"""Most derivatives of phasors that are remembered, 16 bytes each [-]: those of two hundred unknowns at some hundred speeds."""
SMALLEST_AMPLITUDE = 0.01
"""Least amplitude of a channel as a part of the sample's largest, for the weights before there is a fit [-]."""


class FitResult(Struct, frozen=True, eq=False):
    """End of a fit from one start.

    Attributes:
        theta: Fit coordinates θ (n,) [-].
        chi_square: χ² of the phasors at the final weights [-].
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


class FitProblem(Struct, frozen=True, eq=False):
    """One data set, one train, one set of coordinates.

    Attributes:
        train: The condensed train.
        measurement: Measured phasors at the train's S speeds.
        coordinates: Coordinates of the fit.
        noise: Noise model.
        outlier: True for phasors left out (S, m).
        robust: Whether outliers are left out at all.
        channel_noise: Noise of each channel over the noise model's, (m,) or (1,) [-].
        gaps: Gaps that are fitted with the phasors; None for none.
    """

    train: CondensedTrain
    measurement: Measurement
    coordinates: Coordinates
    noise: Noise
    outlier: NDArray[np.bool_]
    robust: bool = True
    channel_noise: Floats = field(default_factory=lambda: np.ones(1))
    gaps: GapRows | None = None
    _scaled: dict[bytes, CondensedTrain] = field(default_factory=dict)
    _memory: PhasorMemory = field(default_factory=PhasorMemory)

    @property
    def _sources(self) -> Sources:
        return self.coordinates, self.train, self.measurement

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
        known = self._memory.phasors(self._sources, theta)
        if known is not None:
            return known
        phasor = response(
            self.scaled_train(theta),
            coefficients=self.coordinates.coefficients(theta),
            excitations=self.excitations(theta),
        )
        found = self.coordinates.channels.as_measured(theta, phasor, self.measurement.direction)
        self._memory.keep_phasors(self._sources, theta, found)
        return found

    def linear_phasors(self, theta: Floats) -> Iterator[LinearPhasors]:
        """Yield the phasors and their derivatives at θ, some of the speeds at a time; the last ones are remembered.

        Args:
            theta: Fit coordinates θ (n,) [-].

        Yields:
            Phasors and derivatives, which may not be changed.
        """
        size = theta.size * self.measurement.phasor.size
        known = self._memory.linear(self._sources, theta)
        if known is not None:
            yield known
            return
        train = self.scaled_train(theta)
        excitations = self.excitations(theta)
        for block in [slice(0, train.speed.size)] if size <= LARGEST_KEPT else train.blocks():
            found = linear_phasors(
                train, self.coordinates, theta, excitations=excitations, direction=self.measurement.direction, block=block
            )
            if size <= LARGEST_KEPT:
                self._memory.keep_linear(self._sources, theta, found)
            yield found

    def with_channels(self, coordinates: Coordinates, theta: Floats) -> "FitProblem":
        """Return the problem with more coordinates of channels behind its own.

        Args:
            coordinates: The coordinates, this problem's first.
            theta: Fit coordinates θ (n,), at which the others are zero [-].

        Returns:
            The problem.
        """
        found = replace(self, coordinates=coordinates, _memory=PhasorMemory())
        known = self._memory.linear(self._sources, theta)
        if known is not None:
            whole = np.concatenate([theta, np.zeros(coordinates.size - theta.size)])
            found._memory.keep_linear(found._sources, whole, known.extended(coordinates, self.measurement.direction))
        return found

    def linearised(self, theta: Floats, weight: Floats) -> tuple[float, Floats, Floats]:
        """Linearise the problem at θ.

        Args:
            theta: Fit coordinates θ (n,) [-].
            weight: Weights (S, m) [1/m].

        Returns:
            χ² of the data, gaps included [-], -½ of its gradient (n,) [-] and its Gauss-Newton curvature (n, n) [-].
        """
        weight = np.where(self.used, weight, 0.0)
        chi_square, gradient, curvature = linearised_gaps(self.gaps, theta)
        for found in self.linear_phasors(theta):
            rows, parts = found.weighted(self.measurement.phasor, weight)
            chi_square += float(parts @ parts)
            gradient += rows @ parts
            curvature += rows @ rows.T
        return chi_square, gradient, curvature

    def chi_square(self, theta: Floats, weight: Floats) -> float:
        """Compute χ²: the sum of squared weighted residuals, real and imaginary parts counted apart, and that of the gaps.

        Args:
            theta: Fit coordinates θ (n,) [-].
            weight: Weights (S, m) [1/m].

        Returns:
            χ² [-].
        """
        residual = ((self.measurement.phasor - self.model(theta)) * weight)[self.used]
        return float(np.vdot(residual, residual).real) + gap_cost(self.gaps, theta)

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


@singledispatch
def best_excitations(problem: FitProblem, theta: Floats, weight: Floats) -> Floats:
    """Solve for the excitations that fit best while everything else stays: a linear problem.

    Source: Golub and Pereyra, SIAM J. Numer. Anal. 10 (1973) 413, doi:10.1137/0710036.

    Args:
        problem: The problem.
        theta: Fit coordinates θ (n,) [-].
        weight: Weights (S, m) [1/m].

    Returns:
        θ (n,) with these unbalances, bows and loads [-]; as it was where there is no model.
    """
    of_one = np.flatnonzero(problem.coordinates.excitation_place >= 0)
    if of_one.size == 0:
        return theta
    first = problem.coordinates.excitation_place[of_one]
    free = np.stack([first, first + 1], axis=1).reshape(-1)
    each = excitation_responses(problem.scaled_train(theta), coefficients=problem.coordinates.coefficients(theta))
    excitations = problem.excitations(theta)
    parts = np.stack([excitations.real, excitations.imag], axis=-1).reshape(*excitations.shape[:-1], -1)
    phasor = np.einsum("esm,e->sm" if parts.ndim == 1 else "esm,se->sm", each, parts)
    channels, weight = problem.coordinates.channels, np.where(problem.used, weight, 0.0)
    residual = (problem.measurement.phasor - channels.as_measured(theta, phasor, problem.measurement.direction)) * weight
    slope = each.reshape(-1, 2, *phasor.shape)[of_one].reshape(free.size, *phasor.shape)
    slope = slope * np.repeat(problem.coordinates.excitation_scale[of_one], 2)[:, None, None]
    rows = (slope * (channels.gains(theta) * weight)).reshape(free.size, -1).view(float)
    if not np.isfinite(rows).all():
        return theta  # where a film is too thin
    block = rows @ rows.T + problem.coordinates.prior.precision[np.ix_(free, free)]
    # At the given excitations the model is linear in them: one Newton step is the answer.
    offset = problem.coordinates.prior.pull(theta)[free]
    result = theta.copy()
    result[free] += np.linalg.solve(block, rows @ residual.reshape(-1).view(float) - offset)
    return result
