"""Check of intervals where a fit is badly conditioned: the likelihood's profile at their ends.

An interval of ± 1.96 standard errors takes the likelihood for Gaussian. Where the data hardly determine some directions it is
not: the misfit may stay flat far beyond. So a parameter is moved by two standard errors either way, everything else is fitted
anew, and the misfit must rise by nearly what a Gaussian would show (Venzon and Moolgavkar, Appl. Statist. 37 (1988) 87,
doi:10.2307/2347496). The fit of everything else ends as soon as the answer is known: the misfit has fallen below that rise, or
a whole Newton step is not promised to bring it there.
"""

from collections.abc import Sequence

import numpy as np

from estimator.arrays import Floats
from estimator.fit.optimisation.reweighting import with_fitted_noise
from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.rotor.elimination import SingularCondensation

ENDS = 2.0
"""Standard errors by which a parameter is moved [-]."""
SMALLEST_RISE = 0.83
"""Part of the Gaussian rise of χ², ENDS², below which an interval is too short to be believed [-]: it holds 92.6 %."""
LARGEST_STEP_COUNT = 30
"""Most steps of the fit of everything else."""
STEP_LIMIT = 1.0
"""Largest change of a coordinate in one step [-]: a factor e of a direct term."""
PROMISE = 1.5
"""Factor on the decrease that a Newton step promises, which a curved valley may exceed [-]."""


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
    profile = _Profile(final, final.weight(np.abs(final.model(found.theta)), 0.0))
    wanted = profile.cost(found.theta) + SMALLEST_RISE * ENDS**2
    return frozenset(
        place
        for place in places
        if any(profile.falls_below(wanted, _moved(found.theta, covariance, place, side), place) for side in (-ENDS, ENDS))
    )


def _moved(theta: Floats, covariance: Floats, place: int, side: float) -> Floats:
    """Return where a Gaussian's ridge would lead when one coordinate is moved by `side` standard errors."""
    return np.asarray(theta + side * covariance[place] / np.sqrt(covariance[place, place]))


class _Profile:
    """χ² with its prior, at given weights, as a function of all coordinates but one."""

    def __init__(self, problem: FitProblem, weight: Floats) -> None:
        self.problem = problem
        self.weight = weight

    def cost(self, theta: Floats) -> float:
        """Compute χ² with its prior."""
        return self.problem.chi_square(theta, self.weight) + self.problem.coordinates.prior.cost(theta)

    def falls_below(self, wanted: float, theta: Floats, place: int) -> bool:
        """Check whether the cost falls below `wanted` when every coordinate but one is fitted anew from θ."""
        cost = self.cost(theta)
        for _ in range(LARGEST_STEP_COUNT):
            if cost < wanted:
                return True
            step, promised = self._newton_step(theta, place)
            if cost - PROMISE * promised >= wanted:
                return False
            shorter = min(1.0, STEP_LIMIT / max(float(np.max(np.abs(step))), 1e-300))
            theta, before = self._lower(theta, cost, shorter * step), cost
            cost = self.cost(theta)
            if cost >= before:
                return False
        return False

    def _newton_step(self, theta: Floats, place: int) -> tuple[Floats, float]:
        """Return the Gauss-Newton step of the other coordinates, and the decrease of the cost that it promises."""
        _, gradient, curvature = self.problem.linearised(theta, self.weight)
        others = np.arange(theta.size) != place
        prior = self.problem.coordinates.prior
        slope = (gradient - prior.pull(theta))[others]
        step = np.zeros(theta.size)
        step[others] = np.linalg.solve((curvature + prior.precision)[np.ix_(others, others)], slope)
        return step, float(slope @ step[others])

    def _lower(self, theta: Floats, cost: float, step: Floats) -> Floats:
        """Return the first point of lower cost along a step that is halved; the point itself where there is none."""
        for halving in range(4):
            trial = theta + step / 2**halving
            try:
                if self.cost(trial) < cost:
                    return np.asarray(trial)
            except SingularCondensation:
                continue  # E or density went where a speed cannot be condensed at: a shorter step
        return theta
