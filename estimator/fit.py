"""Maximum-likelihood fit of a train's response, from one start.

Output error: the residual is measured minus modelled response, weighted by its measurement error, so that noise does not
bias the estimate (an equation-error regression, thesis Eq. 4.71, puts noise into the regressors). Levenberg-Marquardt with
exact sensitivities (Marquardt, J. SIAM 11 (1963) 431, doi:10.1137/0111030), in the coordinates of `coordinates`. Weights
sharpen in stages: the first stages allow a relative misfit beside the noise, which flattens the valleys that a shifted
resonance leaves, the last has the noise alone.
"""

from dataclasses import dataclass

import numpy as np

from estimator.condensation import Complexes, CondensedTrain, Floats
from estimator.coordinates import Coordinates
from estimator.machine import Noise
from estimator.measurement import Measurement, error_size
from estimator.response import response
from estimator.sensitivity import sensitivity

STAGE_MISFITS = (0.5, 0.05, 0.0)
"""Relative misfit allowed beside the noise in each stage."""
STAGE_ITERATIONS = (40, 40, 80)
FINAL_PASSES = 3
"""Times the last stage is repeated with weights from the response just fitted."""
STEP_LIMIT = 1.0
"""Largest change of a coordinate in one step: a factor e of a direct term."""
CONVERGED_DECREASE = 1e-3
"""A stage ends when a step promises to lower χ² by less than this; a change of 1 is one standard error."""


@dataclass(frozen=True)
class Fit:
    """Where one start led.

    theta: fit coordinates (K + 2P,). chi_square: of the data at the final weights. information: Fisher information of the
    data in the coordinates, (K + 2P, K + 2P). converged: whether the last stage met its tolerance. iterations: steps tried.
    """

    theta: Floats
    chi_square: float
    information: Floats
    converged: bool
    iterations: int


@dataclass(frozen=True)
class Problem:
    """One data set, one train, one set of coordinates."""

    train: CondensedTrain
    measurement: Measurement
    coordinates: Coordinates
    noise: Noise

    def model(self, theta: Floats) -> Complexes:
        """Response (S, m) [m] at θ."""
        return response(
            self.train,
            coefficients=self.coordinates.coefficients(theta),
            unbalances=self.coordinates.unbalances(theta),
        )

    def linearised(self, theta: Floats, weight: Floats) -> tuple[float, Floats, Floats]:
        """χ² of the data, -½ of its gradient and its Gauss-Newton curvature at θ, for weights (S, m) [1/m]."""
        modelled, by_parameter = sensitivity(
            self.train,
            coefficients=self.coordinates.coefficients(theta),
            unbalances=self.coordinates.unbalances(theta),
        )
        used = self.measurement.usable
        residual = ((self.measurement.phasor - modelled) * weight)[used]
        slope = by_parameter[used] * weight[used][:, None]
        slope *= self.coordinates.slope(theta)
        adjoint = slope.conj().T
        return float(np.vdot(residual, residual).real), (adjoint @ residual).real, (adjoint @ slope).real

    def chi_square(self, theta: Floats, weight: Floats) -> float:
        """Sum of squared weighted residuals, real and imaginary parts counted apart."""
        residual = ((self.measurement.phasor - self.model(theta)) * weight)[self.measurement.usable]
        return float(np.vdot(residual, residual).real)

    def weight(self, amplitude: Floats, misfit: float) -> Floats:
        """Weights (S, m) [1/m]: one over the error of each real part, with a relative misfit allowed beside it."""
        error = error_size(self.noise, amplitude, self.measurement.scatter)
        whole = np.sqrt(error**2 + (misfit * amplitude) ** 2)
        # A response of exactly zero under a noise without floor: its error is unknown, so it does not count.
        return np.divide(np.sqrt(2.0), whole, out=np.zeros_like(whole), where=whole > 0.0)

    def best_unbalances(self, theta: Floats, weight: Floats) -> Floats:
        """θ with the unbalances that fit best while the coefficients stay: a linear problem."""
        count = self.coordinates.coefficient_count
        _, gradient, curvature = self.linearised(theta, weight)
        block = curvature[count:, count:] + np.diag(self.coordinates.spread[count:] ** -2)
        # At the given unbalances the model is linear in them: one Newton step is the answer.
        step = np.linalg.solve(block, gradient[count:] - (theta[count:] / self.coordinates.spread[count:] ** 2))
        result = theta.copy()
        result[count:] += step
        return result


def fit(problem: Problem, start: Floats) -> Fit:
    """Fit from one start θ (K + 2P,)."""
    measured = np.abs(problem.measurement.phasor)
    theta = start
    iterations = 0
    for misfit, limit in zip(STAGE_MISFITS, STAGE_ITERATIONS, strict=True):
        weight = problem.weight(measured, misfit)
        theta, converged, steps = _descend(problem, theta, weight, limit)
        iterations += steps
    for _ in range(FINAL_PASSES - 1):
        if not converged:
            break
        weight = problem.weight(np.abs(problem.model(theta)), 0.0)
        theta, converged, steps = _descend(problem, theta, weight, STAGE_ITERATIONS[-1])
        iterations += steps
    chi_square, _, information = problem.linearised(theta, weight)
    return Fit(theta, chi_square, information, converged, iterations)


def _descend(problem: Problem, theta: Floats, weight: Floats, limit: int) -> tuple[Floats, bool, int]:
    """Levenberg-Marquardt at fixed weights: (θ, converged, steps tried).

    The damping follows the gain ratio smoothly (Nielsen, IMM-REP-1999-05, Technical University of Denmark).
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
        step = np.linalg.solve(hessian + damping * np.diag(np.diag(hessian)), slope)
        step *= min(1.0, STEP_LIMIT / max(float(np.max(np.abs(step))), 1e-300))
        promised = float(2 * slope @ step - step @ hessian @ step)
        if promised < CONVERGED_DECREASE:
            return theta, True, step_number
        trial = theta + step
        trial_cost = penalised(problem.chi_square(trial, weight), trial)
        gain = (cost - trial_cost) / promised
        if np.isfinite(trial_cost) and gain > 1e-4:
            theta = trial
            data, gradient, curvature = problem.linearised(theta, weight)
            cost = penalised(data, theta)
            damping, growth = max(damping * max(0.2, 1.0 - (2.0 * min(gain, 1.0) - 1.0) ** 3), 1e-9), 2.0
        else:
            damping, growth = max(damping, 1e-6) * growth, 2.0 * growth
    return theta, False, limit
