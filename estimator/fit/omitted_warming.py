"""Judgement of whether oil films want their viscosity to follow the speed, where the document gives each film one viscosity.

Oil warms with speed. A fit without that bends clearances, elevations and deviations until the data are met. The score shows it
at the fit's end, without another fit: the derivative of the likelihood by an exponent t, of a viscosity in proportion to
(speed)⁻ᵗ in all films alike, over its standard deviation (Rao, Proc. Camb. Phil. Soc. 44 (1948) 50,
doi:10.1017/S0305004100023987).
"""

import math
from dataclasses import dataclass

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.fit.problem.placed_models import PlacedModel
from estimator.fit.reweighting import with_fitted_noise
from estimator.rotor.response import Sensitivity

LARGEST_SCORE = 3.3
"""Largest score in standard deviations [-]: 1 of 1000 is larger where viscosity is the same at every speed."""


@dataclass(frozen=True)
class ViscosityTrend:
    """Exponent t of a viscosity in proportion to (speed)⁻ᵗ that the residuals of a fit without it ask for.

    Attributes:
        exponent: The exponent [-].
        error: Its standard error [-].
    """

    exponent: float
    error: float

    @property
    def words(self) -> str:
        """Return the words on the viscosity's change with speed; empty where none is significant."""
        score = self.exponent / self.error
        if abs(score) <= LARGEST_SCORE:
            return ""
        fall = "falls" if self.exponent > 0.0 else "rises"
        return (
            f"the oil films' viscosity {fall} with speed, about as its power {-self.exponent:.2g} ({abs(score):.2g} standard "
            "errors): the document gives one viscosity for every speed"
        )


def viscosity_trend(problem: FitProblem, found: FitResult, covariance: Floats) -> ViscosityTrend | None:
    """Estimate the trend of viscosity that the residuals of a fit ask for (Rao 1948, doi:10.1017/S0305004100023987).

    Args:
        problem: The fit's problem.
        found: The fit.
        covariance: Covariance (n, n) of the fit coordinates [-].

    Returns:
        The trend; None where no coefficients follow from films, or the data say nothing of it.
    """
    if not problem.coordinates.models:
        return None
    from estimator.statics.film_curves import FilmCurves  # films are loaded where coefficients follow the speed

    final = with_fitted_noise(problem, found)
    placed = next((one for one in final.coordinates.models if isinstance(one.curves, FilmCurves)), None)
    if placed is None:
        return None
    own, mixed, slope = _information(final, found.theta, placed)
    left = own - float(mixed @ covariance @ mixed)
    return None if left <= 0.0 else ViscosityTrend(slope / left, 1.0 / math.sqrt(left))


def _information(problem: FitProblem, theta: Floats, placed: PlacedModel) -> tuple[float, Floats, float]:
    """Compute the information of the exponent, that which it shares with the coordinates (n,), and half its score."""
    weight = np.where(problem.used, problem.weight(np.abs(problem.model(theta)), 0.0), 0.0)
    own, mixed, slope = 0.0, np.zeros(theta.size), 0.0
    for found in problem.linear_phasors(theta):
        rows, residual = found.weighted(problem.measurement.phasor, weight)
        moved = _moved(placed, theta, found.sensitivity, found.block)
        moved *= problem.coordinates.channels.gains(theta) * weight[found.block]
        parts = moved.reshape(-1).view(float)
        own += float(parts @ parts)
        mixed += rows @ parts
        slope += float(parts @ residual)
    return own, mixed, slope


def _moved(placed: PlacedModel, theta: Floats, found: Sensitivity, block: slice) -> Complexes:
    """Return the derivatives (S, m) of phasors by the exponent."""
    from estimator.statics.film_curves import FilmCurves

    if not isinstance(placed.curves, FilmCurves):
        raise TypeError("only films have a viscosity")
    by_exponent = placed.curves.viscosity_trend(placed.own(theta))[block]
    return np.asarray(np.einsum("sc,csm->sm", by_exponent, found.by_coefficient[list(placed.coefficients)]))
