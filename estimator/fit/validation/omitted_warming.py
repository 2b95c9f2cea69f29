"""Judgement of whether oil films want their viscosity to follow the speed, where the document gives each film one viscosity.

Oil warms with speed. A fit without that bends clearances, elevations and deviations until the data are met. The score of an
exponent t, of a viscosity in proportion to (speed)⁻ᵗ in all films alike, shows it (`omitted_parameter`).
"""

from estimator.arrays import Floats
from estimator.fit.optimisation.reweighting import with_fitted_noise
from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.fit.validation.omitted_parameter import OmittedParameter, omitted_parameter

LARGEST_SCORE = 3.3
"""Largest score in standard deviations [-]: 1 of 1000 is larger where viscosity is the same at every speed."""


def viscosity_trend(
    problem: FitProblem, found: FitResult, covariance: Floats, *, inflation: float = 1.0
) -> OmittedParameter | None:
    """Estimate the exponent t of a viscosity in proportion to (speed)⁻ᵗ that the residuals of a fit without it ask for.

    Args:
        problem: The fit's problem.
        found: The fit.
        covariance: Covariance (n, n) of the fit coordinates, as independent residuals have it [-].
        inflation: Factor on variances, as neighbouring residuals are alike [-].

    Returns:
        The exponent [-]; None where no coefficients follow from films, or the data say nothing of it.
    """
    if not problem.coordinates.models:
        return None
    from estimator.statics.film_curves import FilmCurves  # films are loaded where coefficients follow the speed

    for placed in problem.coordinates.models:
        if isinstance(placed.curves, FilmCurves):
            by_exponent = placed.curves.viscosity_trend(placed.own(found.theta))
            final = with_fitted_noise(problem, found)
            return omitted_parameter(final, found.theta, covariance, placed, by_exponent, inflation=inflation)
    return None


def warming_words(trend: OmittedParameter | None) -> str:
    """Return the words on the viscosity's change with speed.

    Args:
        trend: The exponent that the residuals ask for.

    Returns:
        The words; empty where none is significant.
    """
    if trend is None or abs(trend.score) <= LARGEST_SCORE:
        return ""
    fall = "falls" if trend.value > 0.0 else "rises"
    return (
        f"the oil films' viscosity {fall} with speed, about as its power {-trend.value:.2g} ({abs(trend.score):.2g} standard "
        "errors): the document gives one viscosity for every speed"
    )
