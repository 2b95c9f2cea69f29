"""Deviation of coefficients from the form that a document gives them over speed, as the residuals of a fit show it.

χ² alone cannot see that an assumed form is wrong: the coefficients of one bearing make up for what those of another may not
do. So each free coefficient is given a deviation over speed beside its form, a Gaussian process of one common relative size τ
(Kennedy and O'Hagan, J. R. Stat. Soc. B 63 (2001) 425, doi:10.1111/1467-9868.00294). τ is estimated by restricted maximum
likelihood (Harville, J. Am. Stat. Assoc. 72 (1977) 320, doi:10.1080/01621459.1977.10480998): where the form is right it is
zero, and nothing changes. Where it is not, the covariance grows by what the deviations leave open; where it is large, the form
is refused.
"""

from dataclasses import dataclass

import numpy as np
import scipy.optimize

from estimator.arrays import Floats
from estimator.fit.fit_problem import FitProblem, FitResult
from estimator.fit.phasor_jacobian import phasor_jacobian
from estimator.fit.reweighting import with_fitted_noise
from estimator.rotor.response import sensitivity

CORRELATION_LENGTH = 0.4
"""Distance over which a deviation stays alike, as a part of the speed range [-]."""
SMALLEST_VARIANCE_PART = 0.01
"""Part of a deviation's variance that its left-out shapes may hold [-]."""
SIGNIFICANT = 6.6
"""Twice the logarithm of the likelihood ratio from which on a deviation is believed [-]: 1 in 200 where there is
none."""
GRID = 60
"""Number of points over which shapes are computed."""
LARGEST_SIZE = 10.0
"""Largest relative size of deviations that is looked for [-]."""


@dataclass(frozen=True)
class FormDiscrepancy:
    """Deviations of coefficients from their forms.

    Attributes:
        size: Relative size τ of the deviations, rms [-]; 0 where the data show none.
        evidence: Twice the logarithm of the likelihood ratio against no deviation [-].
        covariance: Covariance (n, n) of the fit coordinates with them [-].
    """

    size: float
    evidence: float
    covariance: Floats


def form_discrepancy(problem: FitProblem, found: FitResult, covariance: Floats) -> FormDiscrepancy:
    """Estimate how far the coefficients deviate from their forms over speed (Kennedy and O'Hagan 2001; Harville 1977).

    Args:
        problem: The fit's problem.
        found: The fit.
        covariance: Covariance (n, n) of the fit coordinates without deviations [-].

    Returns:
        The deviations' size, and the covariance that they leave.
    """
    deviations = _Deviations.of(problem, found, covariance)
    size, evidence = deviations.likeliest()
    if evidence < SIGNIFICANT:
        return FormDiscrepancy(0.0, max(0.0, evidence), covariance)
    return FormDiscrepancy(size, evidence, deviations.widened(covariance, size))


@dataclass(frozen=True)
class _Deviations:
    """Deviations of D shapes in all, of unit size, in a fit of n coordinates.

    Attributes:
        curvature: Their information (D, D) after the coordinates were fitted anew [-].
        slope: ½ of the derivative of -χ² by them (D,) [-].
        answer: Change of the coordinates per unit of each (n, D) that leaves the data as they are [-].
        at: Deviation of each coordinate's own coefficient at its own speed (n, D) [-]; 0 for other coordinates.
    """

    curvature: Floats
    slope: Floats
    answer: Floats
    at: Floats

    @classmethod
    def of(cls, problem: FitProblem, found: FitResult, covariance: Floats) -> "_Deviations":
        final = with_fitted_noise(problem, found)
        knots = [one.speed for one in final.coordinates.parameters if one.speed is not None]
        speeds = np.concatenate([final.measurement.speed, knots])
        shapes = DeviationShapes(float(speeds.min()), float(speeds.max()))
        own, mixed, slope = _information(final, found.theta, shapes)
        answer = -covariance @ mixed
        return cls(own + mixed.T @ answer, slope, answer, _at_own_speed(final, found.theta, shapes))

    def likeliest(self) -> tuple[float, float]:
        """Return the most likely size [-] and twice the logarithm of its likelihood ratio against none [-]."""
        information, vectors = np.linalg.eigh(self.curvature)
        information = np.maximum(information, 0.0)
        power = (vectors.T @ self.slope) ** 2

        def ratio(log_size: float) -> float:
            variance = np.exp(2.0 * log_size)
            return float(np.sum(power * variance / (1.0 + variance * information) - np.log1p(variance * information)))

        highest = np.log(LARGEST_SIZE)
        # Below this size even the best determined shape would not be seen.
        lowest = min(-0.5 * np.log(max(float(information.max(initial=0.0)), 1e-300)) - 2.0, highest - 1.0)
        sizes = np.linspace(lowest, highest, 60)
        near = int(np.argmax([ratio(one) for one in sizes]))
        bounds = (sizes[max(0, near - 1)], sizes[min(sizes.size - 1, near + 1)])
        best = scipy.optimize.minimize_scalar(lambda one: -ratio(one), bounds=bounds, method="bounded")
        return float(np.exp(best.x)), -float(best.fun)

    def widened(self, covariance: Floats, size: float) -> Floats:
        """Return the covariance (n, n) of the coordinates with deviations of some size, their most likely shift included."""
        open_part = np.linalg.inv(self.curvature + np.eye(self.slope.size) / size**2)
        moved = self.answer + self.at
        shift = moved @ (open_part @ self.slope)
        return np.asarray(covariance + moved @ open_part @ moved.T + np.outer(shift, shift))


class DeviationShapes:
    """Shapes of a deviation over a range of speeds, by which it is a sum of independent numbers of unit variance.

    Those of a Gaussian process of squared exponential correlation (Karhunen-Loève, by Nyström's method; Rasmussen and
    Williams, Gaussian Processes for Machine Learning, 2006, sec. 4.3).
    """

    def __init__(self, low: float, high: float) -> None:
        self.low = low
        self.high = high
        self.grid = np.linspace(0.0, 1.0, GRID)
        variance, vectors = np.linalg.eigh(_correlation(self.grid, self.grid))
        variance, vectors = variance[::-1], vectors[:, ::-1]
        held = np.cumsum(variance) / variance.sum()
        count = int(np.searchsorted(held, 1.0 - SMALLEST_VARIANCE_PART)) + 1
        self.weight = vectors[:, :count] / np.sqrt(variance[:count])

    def at(self, speed: Floats) -> Floats:
        """Compute the shapes at some speeds.

        Args:
            speed: Speeds (S,) [rad/s].

        Returns:
            Shapes (S, B) [-].
        """
        place = (speed - self.low) / max(self.high - self.low, 1e-300)
        return np.asarray(_correlation(np.clip(place, 0.0, 1.0), self.grid) @ self.weight)


def _correlation(first: Floats, second: Floats) -> Floats:
    return np.asarray(np.exp(-0.5 * ((first[:, None] - second) / CORRELATION_LENGTH) ** 2))


def _information(problem: FitProblem, theta: Floats, shapes: DeviationShapes) -> tuple[Floats, Floats, Floats]:
    """Compute the information of unit deviations (D, D), that which they share with the coordinates (n, D), and ½ of the
    derivative of -χ² by them (D,)."""
    coordinates, train = problem.coordinates, problem.scaled_train(theta)
    coefficients, excitations = coordinates.coefficients(theta), problem.excitations(theta)
    weight = np.where(problem.used, problem.weight(np.abs(problem.model(theta)), 0.0), 0.0)
    owner = _owners(problem)
    sizes = _sizes(problem, coefficients)
    count = (int(owner.max(initial=-1)) + 1) * shapes.weight.shape[1]
    own, mixed, slope = np.zeros((count, count)), np.zeros((theta.size, count)), np.zeros(count)
    for block in train.blocks():
        found = sensitivity(
            train.pick(block),
            coefficients=coefficients if coefficients.ndim == 1 else coefficients[block],
            excitations=excitations if excitations.ndim == 1 else excitations[block],
        )
        direction = problem.measurement.direction[block]
        modelled = coordinates.channels.as_measured(theta, found.phasor, direction)
        residual = ((problem.measurement.phasor[block] - modelled) * weight[block]).reshape(-1).view(float)
        jacobian = phasor_jacobian(coordinates, theta, found, coefficients=coefficients, direction=direction, block=block)
        rows = (jacobian * weight[block]).reshape(theta.size, -1).view(float)
        moved = np.zeros((count // shapes.weight.shape[1], *found.phasor.shape), dtype=complex)
        for k in np.flatnonzero(owner >= 0).tolist():
            moved[owner[k]] += found.by_coefficient[k] * sizes[k if sizes.ndim == 1 else (block, k)][..., None]
        moved *= coordinates.channels.gains(theta) * weight[block]
        shape = shapes.at(problem.measurement.speed[block])
        deviations = (moved[:, None] * shape.T[:, :, None]).reshape(count, -1).view(float)
        own += deviations @ deviations.T
        mixed += rows @ deviations.T
        slope += deviations @ residual
    return own, mixed, slope


def _owners(problem: FitProblem) -> "np.ndarray[tuple[int], np.dtype[np.intp]]":
    """Return for each coefficient the number of its deviation (K,): a tied one has its leader's, a fixed one none (-1)."""
    coefficients = problem.train.unknowns.coefficients
    free = [one.name for one in coefficients if not one.fixed and one.tied_to is None]
    return np.array([-1 if one.fixed else free.index(one.tied_to or one.name) for one in coefficients], dtype=np.intp)


def _sizes(problem: FitProblem, values: Floats) -> Floats:
    """Return what a deviation of each coefficient is a part of, (K,) or (S, K): itself, or the direct terms beside it [SI]."""
    coefficients = problem.train.unknowns.coefficients
    index = {one.name: k for k, one in enumerate(coefficients)}
    beside = [[index[f"{one.element}.{name}"] for name in one.term.beside] for one in coefficients]
    first, second = (values[..., [pair[side] for pair in beside]] for side in (0, 1))
    return np.asarray(np.sqrt(np.abs(first * second)))


def _at_own_speed(problem: FitProblem, theta: Floats, shapes: DeviationShapes) -> Floats:
    """Return by how much each coordinate's coefficient deviates, at the speed whose value the coordinate is (n, D) [-]."""
    coordinates, names = problem.coordinates, [one.name for one in problem.train.unknowns.coefficients]
    owner, shape_count = _owners(problem), shapes.weight.shape[1]
    found = np.zeros((coordinates.size, (int(owner.max(initial=-1)) + 1) * shape_count))
    everywhere = shapes.at(problem.measurement.speed).mean(axis=0)
    sizes = _sizes(problem, coordinates.coefficients(theta))
    for place, one in enumerate(coordinates.parameters):
        if one.coefficient is None:
            continue
        k = names.index(one.coefficient)
        own = everywhere if one.speed is None else shapes.at(np.array([one.speed]))[0]
        part = 1.0
        if not one.positive:
            size = sizes[k] if sizes.ndim == 1 else np.interp(one.speed or 0.0, *_ascending(problem, sizes[:, k]))
            part = float(size) / one.step
        found[place, owner[k] * shape_count : (owner[k] + 1) * shape_count] = part * own
    return found


def _ascending(problem: FitProblem, values: Floats) -> tuple[Floats, Floats]:
    order = np.argsort(problem.measurement.speed)
    return problem.measurement.speed[order], values[order]
