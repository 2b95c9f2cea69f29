"""Check of intervals where a fit is badly conditioned: the likelihood's profile at their ends.

An interval of ± 1.96 standard errors takes the likelihood for Gaussian. Where the data hardly determine some directions it is
not: the misfit may stay flat far beyond. So a parameter is moved by two standard errors either way, everything else is fitted
anew, and the misfit must rise by nearly what a Gaussian would show (Venzon and Moolgavkar, Appl. Statist. 37 (1988) 87,
doi:10.2307/2347496).
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from estimator.arrays import Floats
from estimator.fit.fit_problem import FitProblem, FitResult
from estimator.fit.maximum_likelihood import descend
from estimator.fit.reweighting import with_fitted_noise

ENDS = 2.0
"""Standard errors by which a parameter is moved [-]."""
SMALLEST_RISE = 0.85
"""Part of the Gaussian rise of χ², ENDS², below which the interval is too short to be believed [-]."""
STEPS = 30
"""Most steps of the fit of everything else."""
PINNED = 1e-3
"""Spread with which the moved parameter is held, in standard errors [-]."""


def flat_coordinates(problem: FitProblem, found: FitResult, covariance: Floats, places: Sequence[int]) -> frozenset[int]:
    """Find the coordinates whose interval the profile does not confirm (Venzon and Moolgavkar 1988, doi:10.2307/2347496).

    Args:
        problem: The fit's problem.
        found: The fit.
        covariance: Covariance (n, n) of the fit coordinates [-].
        places: Indices of the coordinates to check.

    Returns:
        Indices of those that are not confirmed.
    """
    final = with_fitted_noise(problem, found)
    weight = final.weight(np.abs(final.model(found.theta)), 0.0)
    lowest = _cost(final, found.theta, weight)
    wanted = SMALLEST_RISE * ENDS**2
    return frozenset(
        place
        for place in places
        if any(_profile_rise(final, found, covariance, weight, place, side) - lowest < wanted for side in (-ENDS, ENDS))
    )


def _profile_rise(problem: FitProblem, found: FitResult, covariance: Floats, weight: Floats, place: int, side: float) -> float:
    """Compute χ² with its prior after one parameter was moved by `side` standard errors and the others were fitted anew."""
    error = float(np.sqrt(covariance[place, place]))
    # Where a Gaussian's ridge would lead.
    start = found.theta + side * covariance[place] / error
    coordinates = problem.coordinates
    centre, spread = coordinates.centre.copy(), coordinates.spread.copy()
    centre[place], spread[place] = start[place], PINNED * error
    pinned = replace(problem, coordinates=replace(coordinates, centre=centre, spread=spread))
    theta, _, _ = descend(pinned, start, weight, STEPS)
    return _cost(problem, theta, weight)


def _cost(problem: FitProblem, theta: Floats, weight: Floats) -> float:
    coordinates = problem.coordinates
    prior = float(np.sum(((theta - coordinates.centre) / coordinates.spread) ** 2))
    return problem.chi_square(theta, weight) + prior
