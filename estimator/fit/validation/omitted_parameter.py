"""Change of a parameter that a fit takes for known, as the residuals at its end ask for it, without another fit.

The score: the derivative of the likelihood by the parameter, over its standard deviation after the coordinates have answered
(Rao, Proc. Camb. Phil. Soc. 44 (1948) 50, doi:10.1017/S0305004100023987).
"""

import math

import numpy as np
from msgspec import Struct

from estimator.arrays import Floats
from estimator.fit.problem.fit_problem import FitProblem
from estimator.fit.problem.gap_rows import linearised_gaps
from estimator.fit.problem.placed_models import PlacedModel

SEEN = 1e-9
"""Part of a parameter's information that the coordinates must leave for anything to be said of it [-]: less is rounding."""


class OmittedParameter(Struct, frozen=True):
    """Change of a parameter that the residuals of a fit without it ask for.

    Attributes:
        value: The change [its unit].
        error: Its standard error [its unit].
        answer: Change (n,) of the fit coordinates per unit of it that leaves the data as they are [1 per its unit].
    """

    value: float
    error: float
    answer: Floats

    @property
    def score(self) -> float:
        """Return the change in standard errors [-]."""
        return self.value / self.error

    @property
    def variance(self) -> float:
        """Return the mean square by which the parameter may be off, as the change that was seen has it [its unit²].

        The likeliest variance of its prior is value² - error², from one change that was seen (empirical Bayes: Efron and
        Morris, J. Am. Stat. Assoc. 68 (1973) 117, doi:10.1080/01621459.1973.10481350).
        """
        believed = max(0.0, self.value**2 - self.error**2)
        part = believed / (believed + self.error**2)
        return part * self.error**2 + (part * self.value) ** 2

    def widened(self, covariance: Floats) -> Floats:
        """Return the covariance of the coordinates where the parameter may be off by as much as it seems to be.

        Args:
            covariance: Covariance (n, n) with the parameter as the fit takes it [-].

        Returns:
            Covariance (n, n) [-], the coordinates' most likely shift included; the same where |score| is at most one.
        """
        return np.asarray(covariance + self.variance * np.outer(self.answer, self.answer))


def omitted_parameter(
    problem: FitProblem,
    theta: Floats,
    covariance: Floats,
    placed: PlacedModel,
    by_parameter: Floats,
    *,
    inflation: float = 1.0,
) -> OmittedParameter | None:
    """Estimate the change of a parameter that the residuals ask for (Rao 1948, doi:10.1017/S0305004100023987).

    The residuals are those of phasors: gaps hold the coordinates, but what they would say of the parameter itself is left out.

    Args:
        problem: The problem, with the noise and the outliers of the fit's end.
        theta: Fit coordinates θ (n,) there [-].
        covariance: Covariance (n, n) of the fit coordinates, as independent residuals have it [-].
        placed: The model whose c coefficients depend on the parameter.
        by_parameter: Derivatives (S, c) of its coefficients by the parameter [SI per its unit].
        inflation: Factor on variances, as neighbouring residuals are alike [-].

    Returns:
        The change; None where the data say nothing of it.
    """
    weight = np.where(problem.used, problem.weight(np.abs(problem.model(theta)), 0.0), 0.0)
    own, mixed, slope = 0.0, np.zeros(theta.size), 0.0
    gradient = linearised_gaps(problem.gaps, theta)[1] - problem.coordinates.prior.pull(theta)  # what the fit's end has left
    for found in problem.linear_phasors(theta):
        rows, residual = found.weighted(problem.measurement.phasor, weight)
        by_coefficient = found.sensitivity.by_coefficient[list(placed.coefficients)]
        moved = np.einsum("sc,csm->sm", by_parameter[found.block], by_coefficient)
        moved *= problem.coordinates.channels.gains(theta) * weight[found.block]
        parts = moved.reshape(-1).view(float)
        own += float(parts @ parts)
        mixed += rows @ parts
        slope += float(parts @ residual)
        gradient += rows @ residual
    answer = -covariance @ mixed
    left = own + float(mixed @ answer)
    if left <= SEEN * own:
        return None
    return OmittedParameter((slope + float(answer @ gradient)) / left, math.sqrt(inflation / left), answer)
