"""Refused fits that an error explains which their document does not have, and what they say of the machine."""

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from estimator.arrays import Floats
from estimator.fit.problem.coordinates import Coordinates
from estimator.fit.problem.fit_problem import FitResult
from estimator.fit.validation.channel_sensitivity import ChannelEffects


class ExplainedFit(Struct, frozen=True, eq=False):
    """Accepted fit with errors of a coupling or a channel, over the n coordinates of the refused fit without them.

    Attributes:
        point: Values (n,) of the coordinates [SI or 1].
        covariance: Covariance (n, n) of these, the errors being what they are [SI² or 1].
        effects: Effects of errors of channels and couplings, at those that were found.
        refused_chi_square: χ² of the phasors as the curvature says it is without the errors [-].
        degrees_of_freedom: Degrees of freedom of χ².
        outlier: True for phasors left out (S, m).
        words: What explains the data.
    """

    point: Floats
    covariance: Floats
    effects: ChannelEffects
    refused_chi_square: float
    degrees_of_freedom: int
    outlier: NDArray[np.bool_]
    words: str


def own_covariance(own: Coordinates, found: FitResult, *, inflation: float) -> Floats:
    """Return the covariance of a fit's own coordinates where it was done with errors behind them, these being what they are.

    Source: standard result: the conditional covariance of a Gaussian (Rasmussen and Williams, Gaussian Processes for Machine
    Learning, 2006, sec. A.2).

    Args:
        own: The n coordinates.
        found: The fit with errors behind them.
        inflation: Factor by which it is widened [-].

    Returns:
        Covariance (n, n) [SI² or 1].
    """
    precision = found.information[: own.size, : own.size] + own.prior.precision
    size = np.sqrt(np.diag(precision))
    covariance = inflation * np.linalg.inv(precision / np.outer(size, size)) * np.outer(own.unit / size, own.unit / size)
    return np.asarray((covariance + covariance.T) / 2)
