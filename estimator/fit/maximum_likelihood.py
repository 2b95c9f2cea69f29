"""Fit of a train's response from one start: maximum likelihood with a weak prior.

Output error: the residual is measured minus modelled response, weighted by its measurement error, so that noise does not
bias the estimate (an equation-error regression, thesis Eq. 4.71, puts noise into the regressors). Levenberg-Marquardt with
exact sensitivities (Marquardt, J. SIAM 11 (1963) 431, doi:10.1137/0111030), in the coordinates of `coordinates`. Weights
sharpen in stages: the first stages allow a relative misfit beside the noise, which flattens the valleys that a shifted
resonance leaves, the last has the noise alone. Then weights are taken from the fitted response, phasors that cannot be noise
are left out and the noise is estimated where it is not known, again and again until nothing changes: iteratively
reweighted least squares, whose fixed point solves the likelihood equations of Gaussian errors with weights taken as known.
"""

import math
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.fit.coordinates import Coordinates
from estimator.machine.rules import Noise
from estimator.phasors.measurement import Measurement
from estimator.phasors.noise import channel_noise, error_size, estimated_noise, outlier_limit, outliers
from estimator.rotor.condensation import CondensedTrain
from estimator.rotor.elimination import SingularCondensation
from estimator.rotor.response import response, sensitivity

STAGE_MISFITS = (0.5, 0.05, 0.0)
"""Relative misfit allowed beside the noise in each stage [-]."""
STAGE_ITERATIONS = (40, 40, 80)
"""Most steps in each stage."""
FINAL_PASSES = 8
"""Most repetitions of the last stage with weights, outliers and noise from the response just fitted."""
SAME_NOISE = 0.01
"""Relative change of the estimated noise up to which it counts as unchanged [-]."""
SMALLEST_AMPLITUDE = 0.01
"""Least amplitude of a channel as a part of the sample's largest, for the weights before there is a fit [-]."""
STEP_LIMIT = 1.0
"""Largest change of a coordinate in one step [-]: a factor e of a direct term."""
CONVERGED_DECREASE = 1e-3
"""Decrease of χ² promised by a full Newton step below which a stage ends [-]; a change of 1 is one standard error."""


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
            the mean size of its variance.
        channel_noise: Noise of each channel over the noise model's, (m,) or (1,) [-].
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
        return self._as_measured(theta, phasor, self.measurement.direction)

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
            modelled = self._as_measured(theta, found.phasor, direction)
            residual = (self.measurement.phasor[block] - modelled) * weight[block]
            slope = self.coordinates.jacobian(theta, found, coefficients, direction, block) * weight[block]
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
        block = curvature[np.ix_(free, free)] + np.diag(self.coordinates.spread[free] ** -2)
        # At the given excitations the model is linear in them: one Newton step is the answer.
        offset = (theta[free] - self.coordinates.centre[free]) / self.coordinates.spread[free] ** 2
        result = theta.copy()
        result[free] += np.linalg.solve(block, gradient[free] - offset)
        return result

    def without_outliers(self, theta: Floats, misfit: float) -> "FitProblem":
        """Return the problem without the phasors that cannot be noise at θ.

        Args:
            theta: Fit coordinates θ (n,) [-].
            misfit: Relative misfit allowed beside the noise [-].

        Returns:
            The problem with its outliers marked.
        """
        if not self.robust:
            return self
        model = self.model(theta)
        size = np.abs(self.measurement.phasor - model) * self.weight(np.abs(model), misfit) / np.sqrt(2.0)
        if not self.noise.estimated:
            return replace(self, outlier=outliers(size, self.measurement.usable))
        # A channel may be noisier than the others as long as nobody has said how noisy it is.
        each = [outliers(size[:, [c]], self.measurement.usable[:, [c]]) for c in range(size.shape[1])]
        return replace(self, outlier=np.concatenate(each, axis=1))

    def with_estimated_noise(self, theta: Floats) -> "FitProblem":
        """Return the problem with the noise that the residuals at θ show, where the document asks for that.

        Args:
            theta: Fit coordinates θ (n,) [-].

        Returns:
            The problem with that noise, or the same one.
        """
        modelled = self.used & ~(self.measurement.scatter > 0.0)
        if not self.noise.estimated or not np.any(modelled):
            return self
        model = self.model(theta)
        spent = min(0.9, theta.size / (2 * np.count_nonzero(self.used)))
        misfit = np.abs(self.measurement.phasor - model)
        noise = estimated_noise(self.noise, amplitude=np.abs(model)[modelled], misfit=misfit[modelled], spent=spent)
        error = error_size(noise, np.abs(model), np.full(misfit.shape, np.nan))
        size = np.divide(misfit, error, out=np.zeros_like(misfit), where=modelled & (error > 0.0))
        return replace(self, noise=noise, channel_noise=channel_noise(size, modelled, spent=spent))

    def _as_measured(self, theta: Floats, phasor: Complexes, direction: Floats) -> Complexes:
        """Convert phasors to readings, through the channels' gains and with run-out.

        Run-out is a pattern on the shaft, so it is mirrored with the rotation.
        """
        run_out = self.coordinates.run_outs(theta)
        turned = np.where(direction[:, None] > 0, run_out, np.conj(run_out))
        return np.asarray(phasor * self.coordinates.gains(theta) + turned)


def fit(problem: FitProblem, start: Floats, *, near: bool = False) -> FitResult:
    """Fit from one start (Marquardt 1963, doi:10.1137/0111030; method in the module's docstring).

    Args:
        problem: Data, train and coordinates.
        start: Fit coordinates θ (n,) to start from [-].
        near: Whether the start is an earlier fit's end, which needs no coarse stages.

    Returns:
        End of the fit.
    """
    measured = problem.first_amplitude
    theta = start
    iterations = 0
    converged = False
    stages = list(zip(STAGE_MISFITS, STAGE_ITERATIONS, strict=True))
    if near:
        # Weights and what is far too large or small are taken from the earlier fit, so that outliers do not lead away from it.
        measured = np.abs(problem.model(start))
        problem = problem.without_outliers(start, STAGE_MISFITS[-2])
        stages = stages[-2:] if problem.outlier.any() else stages[-1:]
    for misfit, limit in stages:
        theta, converged, steps = descend(problem, theta, problem.weight(measured, misfit), limit)
        problem = problem.without_outliers(theta, misfit)
        iterations += steps
    for _ in range(FINAL_PASSES):
        before = problem
        problem = problem.with_estimated_noise(theta).without_outliers(theta, 0.0)
        weight = problem.weight(np.abs(problem.model(theta)), 0.0)
        theta, converged, steps = descend(problem, theta, weight, STAGE_ITERATIONS[-1])
        iterations += steps
        if not converged or (steps == 0 and _settled(before, problem)):
            break
    chi_square, _, information = problem.linearised(theta, weight)
    return FitResult(
        theta=theta,
        chi_square=chi_square,
        information=information,
        converged=converged,
        iterations=iterations,
        noise=problem.noise,
        outlier=problem.outlier,
        misfit=_misfit(problem, chi_square, weight),
        channel_noise=problem.channel_noise,
    )


def settled(problem: FitProblem, found: FitResult) -> FitProblem:
    """Return the problem with the noise and the outliers of a fit.

    Args:
        problem: The problem.
        found: Its fit.

    Returns:
        The problem at the fit's end.
    """
    return replace(problem, outlier=found.outlier, noise=found.noise, channel_noise=found.channel_noise)


def _misfit(problem: FitProblem, chi_square: float, weight: Floats) -> float:
    whole = chi_square + 2.0 * outlier_limit(problem.measurement.usable) * np.count_nonzero(problem.outlier)
    if not problem.noise.estimated:
        return float(whole)
    return float(whole * np.exp(-2.0 * np.mean(np.log(weight[problem.used & (weight > 0.0)]))))


def _settled(before: FitProblem, after: FitProblem) -> bool:
    """Check whether a pass has changed neither outliers nor noise."""
    return (
        np.array_equal(before.outlier, after.outlier)
        and np.allclose(before.channel_noise, after.channel_noise, rtol=3 * SAME_NOISE)
        and abs(after.noise.relative - before.noise.relative) <= SAME_NOISE * before.noise.relative
        and abs(after.noise.floor - before.noise.floor) <= SAME_NOISE * before.noise.floor
    )


def descend(problem: FitProblem, theta: Floats, weight: Floats, limit: int) -> tuple[Floats, bool, int]:
    """Run Levenberg-Marquardt at fixed weights.

    The damping follows the gain ratio smoothly (Nielsen, IMM-REP-1999-05, Technical University of Denmark).

    Args:
        problem: The problem.
        theta: Fit coordinates θ (n,) to start from [-].
        weight: Weights (S, m) [1/m].
        limit: Most steps.

    Returns:
        θ (n,) [-], whether it converged, and the number of steps tried.
    """
    precision = problem.coordinates.spread**-2
    centre = problem.coordinates.centre

    def penalised(chi_square: float, at: Floats) -> float:
        return chi_square + float(np.sum(precision * (at - centre) ** 2))

    damping, growth = 1e-3, 2.0
    data, gradient, curvature = problem.linearised(theta, weight)
    cost = penalised(data, theta)
    for step_number in range(limit):
        slope = gradient - precision * (theta - centre)
        hessian = curvature + np.diag(precision)
        newton = np.linalg.solve(hessian, slope)
        if float(slope @ newton) < CONVERGED_DECREASE:
            return theta, True, step_number
        step = np.linalg.solve(hessian + damping * np.diag(np.diag(hessian)), slope)
        step *= min(1.0, STEP_LIMIT / max(float(np.max(np.abs(step))), 1e-300))
        promised = float(2 * slope @ step - step @ hessian @ step)
        trial = theta + step
        # Nearly all trials are taken, so their derivatives are computed at once.
        try:
            trial_data, trial_gradient, trial_curvature = problem.linearised(trial, weight)
            trial_cost = penalised(trial_data, trial)
        except SingularCondensation:
            trial_cost = math.inf  # E or density went where a speed cannot be condensed at: a shorter step
        gain = (cost - trial_cost) / promised
        if np.isfinite(trial_cost) and gain > 1e-4:
            theta, cost, gradient, curvature = trial, trial_cost, trial_gradient, trial_curvature
            damping, growth = max(damping * max(0.2, 1.0 - (2.0 * min(gain, 1.0) - 1.0) ** 3), 1e-9), 2.0
        else:
            damping, growth = max(damping, 1e-6) * growth, 2.0 * growth
    return theta, False, limit
