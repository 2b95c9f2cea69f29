"""Deviations of coefficients over speed beside those that a fit has: how large they seem, and what they leave open.

Each is a Gaussian process over speed of one common relative size τ (Kennedy and O'Hagan, J. R. Stat. Soc. B 63 (2001) 425,
doi:10.1111/1467-9868.00294), reckoned with to first order at the fit's end. τ is estimated by restricted maximum likelihood
(Harville, J. Am. Stat. Assoc. 72 (1977) 320, doi:10.1080/01621459.1977.10480998).
"""

from functools import cached_property

import numpy as np
import scipy
from msgspec import Struct
from msgspec.structs import replace
from numpy.typing import NDArray

from estimator.arrays import Floats
from estimator.bearings.deviation_shapes import DeviationShapes
from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.fit.problem.gap_rows import linearised_gaps
from estimator.symmetric_eigen import symmetric_eigen

RULED_OUT = 6.6
"""Twice the logarithm of the likelihood ratio by which a size is ruled out [-]."""
LARGEST_SIZE = 1.0
"""Largest relative size of deviations that is looked for [-]."""

Owners = NDArray[np.intp]
"""Number of the deviation of each coefficient (K,); -1 where it has none."""


class CoefficientDeviations(Struct, frozen=True, eq=False, dict=True):
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
    def of(
        cls, problem: FitProblem, found: FitResult, *, shapes: DeviationShapes, owners: Owners, at: Floats
    ) -> "CoefficientDeviations":
        """Linearise a fit in the deviations of its coefficients.

        The coordinates take away nearly all that the data say of deviations, so that both are weighted alike: beside a fit's
        own information, of a pass whose noise differed by a ten-thousandth, what is left could be less than none.

        Source: Kennedy and O'Hagan, J. R. Stat. Soc. B 63 (2001) 425, doi:10.1111/1467-9868.00294.

        Args:
            problem: The fit's problem, with the noise and the outliers of its end.
            found: The fit.
            shapes: Shapes over speed of each deviation.
            owners: Number of each coefficient's deviation (K,); -1 where it has none.
            at: Deviation of each coordinate's own quantity per unit of each shape (n, D) [-].

        Returns:
            The deviations.
        """
        prior = problem.coordinates.prior
        own, mixed, of_fit, slope, gradient = _information(problem, found.theta, shapes, owners)
        gradient -= prior.pull(found.theta)
        of_fit += prior.precision
        scale = np.sqrt(np.diag(of_fit))
        answer = -np.linalg.solve(of_fit / np.outer(scale, scale), mixed / scale[:, None]) / scale[:, None]
        return cls(own + mixed.T @ answer, slope + answer.T @ gradient, answer, at)

    def inflated(self, inflation: float) -> "CoefficientDeviations":
        """Return the deviations where neighbouring residuals are alike and say less.

        Args:
            inflation: Factor on the variances of the fit [-].

        Returns:
            The deviations.
        """
        return replace(self, curvature=self.curvature / inflation, slope=self.slope / inflation)

    def ratio(self, size: float) -> float:
        """Compute twice the logarithm of the likelihood ratio of a size against none.

        Source: restricted likelihood of Harville, J. Am. Stat. Assoc. 72 (1977) 320, doi:10.1080/01621459.1977.10480998.

        Args:
            size: The size [-].

        Returns:
            Ratio [-].
        """
        return self._ratio(float(np.log(size)))

    def likeliest(self) -> tuple[float, float]:
        """Return the most likely size [-] and twice the logarithm of its likelihood ratio against none [-].

        Source: restricted likelihood of Harville, J. Am. Stat. Assoc. 72 (1977) 320, doi:10.1080/01621459.1977.10480998.

        Returns:
            Size [-] and ratio [-].
        """
        sizes = self._sizes
        near = int(np.argmax(self._ratios))
        bounds = (sizes[max(0, near - 1)], sizes[min(sizes.size - 1, near + 1)])
        best = scipy.optimize.minimize_scalar(lambda one: -self._ratio(one), bounds=bounds, method="bounded")
        return float(np.exp(best.x)), -float(best.fun)

    def largest(self) -> float:
        """Return the largest size that the data do not rule out.

        Source: restricted likelihood of Harville, J. Am. Stat. Assoc. 72 (1977) 320, doi:10.1080/01621459.1977.10480998.

        Returns:
            The size [-].
        """
        ruled_out = self._ratios < max(0.0, float(self._ratios.max())) - RULED_OUT
        return float(np.exp(self._sizes[int(np.argmax(ruled_out))])) if ruled_out[-1] else LARGEST_SIZE

    def _ratio(self, log_size: float) -> float:
        """Compute twice the logarithm of the likelihood ratio of a size, given as its logarithm, against none."""
        information, power = self._spectrum
        variance = np.exp(2.0 * log_size)
        return float(np.sum(power * variance / (1.0 + variance * information) - np.log1p(variance * information)))

    @cached_property
    def _spectrum(self) -> tuple[Floats, Floats]:
        """Return the information (D,) of independent deviations and the squares (D,) of their slopes."""
        information, vectors = self._independent
        return information, (vectors.T @ self.slope) ** 2

    @cached_property
    def _independent(self) -> tuple[Floats, Floats]:
        """Return the information (D,) of independent deviations, never less than none, and these (D, D) by column."""
        information, vectors = symmetric_eigen((self.curvature + self.curvature.T) / 2)
        return np.maximum(information, 0.0), vectors

    @cached_property
    def _sizes(self) -> Floats:
        """Return logarithms of sizes, from one at which even the best determined deviation would not be seen."""
        highest = float(np.log(LARGEST_SIZE))
        lowest = -0.5 * float(np.log(max(float(self._spectrum[0].max(initial=0.0)), 1e-300))) - 2.0
        return np.linspace(min(lowest, highest - 1.0), highest, 100)

    @cached_property
    def _ratios(self) -> Floats:
        return np.array([self._ratio(one) for one in self._sizes])

    def widened(self, covariance: Floats, size: float) -> Floats:
        """Return the covariance of the coordinates with deviations of some size, their most likely shift included.

        Source: Kennedy and O'Hagan, J. R. Stat. Soc. B 63 (2001) 425, doi:10.1111/1467-9868.00294.

        Args:
            covariance: Covariance (n, n) of the fit coordinates without deviations [-].
            size: Size of the deviations [-].

        Returns:
            Covariance (n, n) [-].
        """
        information, vectors = self._independent
        variance = 1.0 / (information + size**-2)
        moved = (self.answer + self.at) @ vectors
        shift = moved @ (variance * (vectors.T @ self.slope))
        return np.asarray(covariance + moved * variance @ moved.T + np.outer(shift, shift))


def _information(
    problem: FitProblem, theta: Floats, shapes: DeviationShapes, owner: Owners
) -> tuple[Floats, Floats, Floats, Floats, Floats]:
    """Compute information matrices and gradients at a fit.

    Returns:
        Information of unit deviations (D, D), between coordinates and deviations (n, D), of the coordinates (n, n); gradient
        of -χ²/2 by the deviations (D,) and by the coordinates (n,).
    """
    coordinates = problem.coordinates
    weight = np.where(problem.used, problem.weight(np.abs(problem.model(theta)), 0.0), 0.0)
    sizes = direct_sizes(problem, coordinates.coefficients(theta))
    count = (int(owner.max(initial=-1)) + 1) * shapes.weight.shape[1]
    own, mixed, slope = np.zeros((count, count)), np.zeros((theta.size, count)), np.zeros(count)
    _, gradient, of_fit = linearised_gaps(problem.gaps, theta)
    for found in problem.linear_phasors(theta):
        block, by_coefficient = found.block, found.sensitivity.by_coefficient
        rows, residual = found.weighted(problem.measurement.phasor, weight)
        moved = np.zeros((count // shapes.weight.shape[1], *found.phasor.shape), dtype=complex)
        for k in np.flatnonzero(owner >= 0).tolist():
            moved[owner[k]] += by_coefficient[k] * sizes[k if sizes.ndim == 1 else (block, k)][..., None]
        moved *= coordinates.channels.gains(theta) * weight[block]
        shape = shapes.at(problem.measurement.speed[block])
        deviations = (moved[:, None] * shape.T[:, :, None]).reshape(count, -1).view(float)
        own += deviations @ deviations.T
        mixed += rows @ deviations.T
        of_fit += rows @ rows.T
        slope += deviations @ residual
        gradient += rows @ residual
    return own, mixed, of_fit, slope, gradient


def direct_sizes(problem: FitProblem, values: Floats) -> Floats:
    """Return what a deviation of each coefficient is a part of: itself, or the direct terms beside it.

    Args:
        problem: The fit's problem.
        values: Coefficients (K,) or (S, K) [SI].

    Returns:
        Sizes (K,) or (S, K) [SI].
    """
    coefficients = problem.train.unknowns.coefficients
    index = {one.name: k for k, one in enumerate(coefficients)}
    beside = [[index[f"{one.element}.{name}"] for name in one.term.beside] for one in coefficients]
    first, second = (values[..., [pair[side] for pair in beside]] for side in (0, 1))
    return np.asarray(np.sqrt(np.abs(first * second)))
