"""Tikhonov regularisation with the parameter chosen by rule (thesis §6.5 asks for it).

min ‖A x - b‖² + λ² ‖x‖² damps the component along each singular vector by the filter factor s²/(s² + λ²).
λ follows from the data: generalised cross-validation (Golub, Heath and Wahba 1979, doi:10.1080/00401706.1979.10489751) or
the corner of the L-curve (Hansen and O'Leary 1993, doi:10.1137/0914086).
"""

from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy.optimize import minimize_scalar

from estimator.arrays import Floats
from estimator.thesis.parameter_rules import RegularisationRule

GRID = 200
"""Number of values of λ, evenly spaced in ln λ, that the rules compare before they refine."""
SMALLEST = 1e-16
"""Smallest λ considered, as a part of the largest singular value [-]."""


@dataclass(frozen=True)
class SpectralProblem:
    """A least-squares problem in the coordinates of its singular vectors.

    Attributes:
        singular_values: Singular values (C,), descending, positive [-].
        components: Components (C,) of the target along the left singular vectors [-].
        remainder: Squared norm of the target outside of them [-].
        rows: Number R of equations.
    """

    singular_values: Floats
    components: Floats
    remainder: float
    rows: int

    @classmethod
    def of(cls, left: Floats, singular_values: Floats, target: Floats) -> Self:
        """Project a target on the left singular vectors.

        Args:
            left: Thin left singular vectors (R, C) [-].
            singular_values: Singular values (C,) [-].
            target: Target (R,) [-].

        Returns:
            The problem.
        """
        components = left.T @ target
        outside = target - left @ components
        return cls(singular_values, components, float(outside @ outside), target.size)

    def residual_square(self, parameter: float) -> float:
        """Compute ‖A x - b‖² of the solution for λ.

        Args:
            parameter: λ [-].

        Returns:
            Squared norm [-].
        """
        damped = damped_parts(self.singular_values, parameter) * self.components
        return float(damped @ damped) + self.remainder

    def solution_square(self, parameter: float) -> float:
        """Compute ‖x‖² of the solution for λ.

        Args:
            parameter: λ [-].

        Returns:
            Squared norm [-].
        """
        x = filter_factors(self.singular_values, parameter) * self.components / self.singular_values
        return float(x @ x)


def filter_factors(singular_values: Floats, parameter: float) -> Floats:
    """Compute the filter factors s²/(s² + λ²).

    Args:
        singular_values: Singular values s (C,) [-].
        parameter: λ [-].

    Returns:
        Factors (C,) [-].
    """
    return np.asarray(1.0 / (1.0 + (parameter / singular_values) ** 2))


def damped_parts(singular_values: Floats, parameter: float) -> Floats:
    """Compute 1 - s²/(s² + λ²) = λ²/(s² + λ²) without the cancellation for small λ.

    Args:
        singular_values: Singular values s (C,) [-].
        parameter: λ [-].

    Returns:
        Parts (C,) [-].
    """
    square = parameter**2
    return np.asarray(square / (singular_values**2 + square))


def generalised_cross_validation(problem: SpectralProblem, parameter: float) -> float:
    """Compute ‖A x - b‖² / (R - Σ f)² with f = s²/(s² + λ²) (Golub, Heath and Wahba 1979).

    An estimate of the mean square error with which left-out equations are predicted, over their number R. Source:
    doi:10.1080/00401706.1979.10489751.

    Args:
        problem: The problem.
        parameter: λ [-].

    Returns:
        Criterion, smaller is better [-].
    """
    damped = damped_parts(problem.singular_values, parameter)
    freedom = problem.rows - damped.size + float(damped.sum())
    return problem.residual_square(parameter) / freedom**2


def l_curve_curvature(problem: SpectralProblem, parameter: float) -> float:
    """Compute the curvature of (ln ‖A x - b‖, ln ‖x‖) over growing λ; positive at the corner (Hansen and O'Leary 1993).

    With η = ‖x‖², ρ = ‖A x - b‖² and dρ/dλ = -λ² dη/dλ it needs no second derivative: 2 ηρ/|η'| (λ²η'ρ + 2ληρ + λ⁴ηη') / (λ⁴η²
    + ρ²)^(3/2). Source: doi:10.1137/0914086.

    Args:
        problem: The problem.
        parameter: λ [-].

    Returns:
        Curvature [-].
    """
    factors = filter_factors(problem.singular_values, parameter)
    damped = damped_parts(problem.singular_values, parameter)
    along = problem.components / problem.singular_values
    solution = problem.solution_square(parameter)
    residual = problem.residual_square(parameter)
    slope = -4.0 / parameter * float(np.sum(damped * (factors * along) ** 2))
    if slope == 0.0 or residual == 0.0:
        return 0.0  # λ is far below every singular value: the curve has not begun to bend
    bend = parameter**2 * slope * residual + 2.0 * parameter * solution * residual + parameter**4 * solution * slope
    return float(2.0 * solution * residual / abs(slope) * bend / (parameter**4 * solution**2 + residual**2) ** 1.5)


def choose_parameter(problem: SpectralProblem, rule: RegularisationRule) -> float:
    """Choose λ by the rule: the best of a grid over the singular values' range, then refined around it.

    The smallest λ considered lies where it changes nothing; a rule that wants no regularisation ends there.

    Args:
        problem: The problem.
        rule: The rule.

    Returns:
        λ [-].
    """
    criterion = generalised_cross_validation if rule == "generalised cross-validation" else _flatness
    largest = float(problem.singular_values[0])
    smallest = max(SMALLEST * largest, 1e-3 * float(problem.singular_values[-1]))
    grid = np.linspace(np.log(smallest), np.log(largest), GRID)
    best = int(np.argmin([criterion(problem, float(np.exp(one))) for one in grid]))
    refined = minimize_scalar(
        lambda logarithm: criterion(problem, float(np.exp(logarithm))),
        bounds=(float(grid[max(best - 1, 0)]), float(grid[min(best + 1, GRID - 1)])),
        method="bounded",
    )
    return float(np.exp(refined.x))


def _flatness(problem: SpectralProblem, parameter: float) -> float:
    return -l_curve_curvature(problem, parameter)
