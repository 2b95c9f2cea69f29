"""Parameters that are fitted only for the due uncertainty of others: how many data they use up, whether they stay small.

They are deviations of oil films from their model. Their estimates over the size that each is believed to have, δ, scatter with
the covariance I - C, C being that which the data leave (Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006,
sec. 2.2), and δᵀ (I - C)⁻¹ δ follows χ². Where it is far larger, the data want more deviation than the document says.
"""

import numpy as np
from numpy.typing import NDArray

from estimator.arrays import Floats
from estimator.fit.optimisation.prior_check import prior_check
from estimator.fit.problem.coordinates import Coordinates
from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.machine.parameter_description import describe

SHARED = "all"
"""Word in place of a film's id in the names of deviations that all films share."""
SMALLEST_CHANCE = 1e-4
"""Chance of deviations as large as those found, beneath which a film's model is refused [-]."""


def counted_by_effect(coordinates: Coordinates) -> NDArray[np.bool_]:
    """Return which coordinates use up only as much freedom as the data say of them: a prior says the rest.

    Args:
        coordinates: Coordinates of a fit.

    Returns:
        True for nuisance parameters and those that a calibration holds (n,).
    """
    found = coordinates.nuisance.copy()
    found[list(coordinates.calibrated_places)] = True
    return found


def effective_count(problem: FitProblem, found: FitResult) -> float:
    """Compute the number of degrees of freedom that nuisance and calibrated parameters use up: priors hold them.

    The trace of the part of the information that comes from the data (Rasmussen and Williams 2006, sec. 2.6).

    Args:
        problem: The fit's problem.
        found: The fit.

    Returns:
        The number [-]; 0 where there are none.
    """
    return effective_number_of(counted_by_effect(problem.coordinates), problem, found)


def effective_number_of(which: NDArray[np.bool_], problem: FitProblem, found: FitResult) -> float:
    """Compute the number of degrees of freedom that some parameters use up, as `effective_count`.

    Source: Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, sec. 2.2.

    Args:
        which: True for those parameters (n,).
        problem: The fit's problem.
        found: The fit.

    Returns:
        The number [-]; 0 where there are none.
    """
    if not which.any():
        return 0.0
    kept = np.linalg.solve(found.information + problem.coordinates.prior.precision, found.information)
    return float(np.trace(kept[np.ix_(which, which)]))


def deviates_too_far(problem: FitProblem, found: FitResult) -> bool:
    """Return whether a fit's films deviate from their model by more than the document says (`excessive_deviations`).

    Source: Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, sec. 2.2.

    Args:
        problem: The fit's problem.
        found: The fit.

    Returns:
        Whether they do; False of a train without films.
    """
    if not problem.coordinates.nuisance.any():
        return False
    covariance = np.linalg.inv(found.information + problem.coordinates.prior.precision)
    return bool(excessive_deviations(problem, found, (covariance + covariance.T) / 2))


def excessive_deviations(problem: FitProblem, found: FitResult, covariance: Floats) -> str:
    """Judge whether films deviate from their model by more than the document says (χ²; module's docstring).

    Each film is judged by itself and all are together: a bore that is not as described shows in its own film. What is said of
    clearances, viscosities and elevations is not judged, for these are what wears and moves.

    Source: Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, sec. 2.2.

    Args:
        problem: The fit's problem.
        found: The fit.
        covariance: Covariance (n, n) of the fit coordinates [-].

    Returns:
        What is wrong; empty where nothing is.
    """
    which = np.flatnonzero(problem.coordinates.nuisance)
    if not which.size:
        return ""
    film = np.array([describe(problem.coordinates.names[place]).element_id for place in which])
    judged = [(f"the oil film of {one} deviates from its model", which[film == one]) for one in sorted(set(film) - {SHARED})]
    judged.append(("oil films deviate from their model", which))
    size = np.array([problem.coordinates.parameters[place].spread for place in which])
    numbers, left = np.zeros(found.theta.size), np.zeros_like(covariance)
    numbers[which] = found.theta[which] / size
    left[np.ix_(which, which)] = covariance[np.ix_(which, which)] / np.outer(size, size)
    found_so = [(prior_check(numbers[places], left[np.ix_(places, places)]), words) for words, places in judged]
    worst, words = min(found_so, key=lambda one: one[0].chance)
    if worst.chance >= SMALLEST_CHANCE:
        return ""
    return (
        f"{words} by {worst.size:.2g} times what the document says (discrepancy): geometry, oil, supports or coupling are "
        "not as described"
    )
