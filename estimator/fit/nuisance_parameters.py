"""Parameters that are fitted only for the due uncertainty of others: how many data they use up, whether they stay small.

They are deviations of oil films from their model, each believed to be of unit size. The fit's estimates of them, δ, scatter
with the covariance I - C, C being that which the data leave (Rasmussen and Williams, Gaussian Processes for Machine Learning,
2006, sec. 2.2), and δᵀ (I - C)⁻¹ δ follows χ². Where it is far larger, the data want more deviation than the document says.
"""

import math

import numpy as np

from estimator.arrays import Floats
from estimator.fit.fit_problem import FitProblem, FitResult

DETERMINED = 0.1
"""Part of a direction's prior variance from which on the data say something of it [-]."""
LIMIT = 5.0
"""Standard deviations by which the squares of deviations may exceed what the document says of their size [-]."""


def effective_count(problem: FitProblem, found: FitResult) -> float:
    """Compute the number of degrees of freedom that the nuisance parameters use up: fewer than there are, as priors hold them.

    The trace of the part of the information that comes from the data (Rasmussen and Williams 2006, sec. 2.6).

    Args:
        problem: The fit's problem.
        found: The fit.

    Returns:
        The number [-]; 0 where there are none.
    """
    which = problem.coordinates.nuisance
    if not which.any():
        return 0.0
    prior = np.diag(problem.coordinates.spread**-2)
    kept = np.linalg.solve(found.information + prior, found.information)
    return float(np.trace(kept[np.ix_(which, which)]))


def excessive_deviations(problem: FitProblem, found: FitResult, covariance: Floats) -> str:
    """Judge whether films deviate from their model by more than the document says (χ²; module's docstring).

    Args:
        problem: The fit's problem.
        found: The fit.
        covariance: Covariance (n, n) of the fit coordinates [-].

    Returns:
        What is wrong; empty where nothing is.
    """
    which = problem.coordinates.nuisance
    if not which.any():
        return ""
    scatter = np.eye(int(which.sum())) - covariance[np.ix_(which, which)]
    variance, directions = np.linalg.eigh((scatter + scatter.T) / 2)
    seen = variance > DETERMINED
    count = int(np.count_nonzero(seen))
    squares = (directions.T @ found.theta[which])[seen] ** 2 / variance[seen]
    if squares.sum() <= count + LIMIT * math.sqrt(2.0 * count):
        return ""
    times = math.sqrt(squares.sum() / count)
    return (
        f"oil films deviate from their model by {times:.2g} times what the document says (discrepancy): geometry, oil, "
        "supports or coupling are not as described"
    )
