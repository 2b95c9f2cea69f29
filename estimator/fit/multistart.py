"""Starts of a fit: the nominal values, then the best of random candidates around them, until starts agree."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats
from estimator.fit.coordinates import Coordinates
from estimator.fit.fit_problem import FitProblem, FitResult, best_excitations
from estimator.fit.maximum_likelihood import STAGE_MISFITS, fit

START_SPREAD_LOG = 0.35
"""Standard deviation of the logarithm of a direct term in a random start [-]."""
START_SPREAD_CROSS = 0.35
"""Standard deviation of a cross-coupled term in a random start, in units of its element's direct terms [-]."""
AGREEING_STARTS = 3
"""Number of starts that must end in the same misfit for it to be believed."""
SAME_MISFIT = 1.01
"""Factor up to which two misfits are the same [-]."""
CANDIDATES = 12
"""Number of random candidates from which each start after the first is the best."""
HOPELESS_MISFIT = 3.0
"""χ²/dof after the coarse stages that leads nowhere [-]: after one start has failed so, others are given up there.

A model that is right leaves less than 1, since these stages allow five per cent of misfit beside the noise.
"""
GUESSED_CANDIDATES = 60
"""Number of random candidates where the document leaves nominal values out."""
GUESSED_SPREAD = 1.5
"""Standard deviation of the logarithm of the factor that all unknown direct terms of a kind share in a candidate [-]."""


class FitFailed(ValueError):
    """Raised when no start leads to a finite misfit."""


@dataclass(frozen=True)
class BestFit:
    """Best of several starts.

    Attributes:
        fit: The best fit.
        starts: Number of starts tried.
        iterations: Number of steps spent in all of them.
    """

    fit: FitResult
    starts: int
    iterations: int


def best_fit(
    problem: FitProblem,
    *,
    starts: int,
    seed: int,
    good: Callable[[FitResult], bool],
    beginning: Floats | None = None,
) -> BestFit:
    """Fit from start after start until one is good, or several agree that it gets no better, or `starts` are spent.

    Args:
        problem: Data, train and coordinates.
        starts: Most starts.
        seed: Seed of the random starts.
        good: Function that accepts a fit.
        beginning: Fit coordinates θ (n,) of the first start, in place of the nominal values [-].

    Returns:
        The best fit.

    Raises:
        FitFailed: No start leads to a finite misfit.
    """
    rng = np.random.default_rng(seed)
    best: FitResult | None = None
    reached: list[float] = []
    give_up_from = math.inf
    iterations = 0
    for start_number in range(1, max(1, starts) + 1):
        if start_number == 1 and beginning is not None:
            found = fit(problem, beginning, near=True)
        else:
            start = _start(problem, rng, first=start_number == 1)
            found = fit(problem, start, give_up_from=give_up_from)
        iterations += found.iterations
        if np.isfinite(found.misfit) and good(found):
            best = found
            break
        if np.isfinite(found.misfit) and (best is None or found.misfit < best.misfit):
            best = found
        reached.append(found.misfit)
        if np.isfinite(found.misfit) and found.coarse_misfit >= HOPELESS_MISFIT and not problem.noise.estimated:
            give_up_from = HOPELESS_MISFIT
        if best is not None and sum(value < SAME_MISFIT * best.misfit for value in reached) >= AGREEING_STARTS:
            break  # the same misfit from everywhere is the data's or the model's, not the start's
    if best is None:
        raise FitFailed(f"none of {start_number} starts led to a finite misfit: are the document's values sensible?")
    return BestFit(best, start_number, iterations)


def _start(problem: FitProblem, rng: np.random.Generator, *, first: bool) -> Floats:
    """Choose the nominal values, else the best of some random candidates by their first-stage misfit."""
    coordinates = problem.coordinates
    weight = problem.weight(problem.first_amplitude, STAGE_MISFITS[0])
    if first and not coordinates.guessed.any():
        return best_excitations(problem, coordinates.centre, weight)
    candidates = [
        best_excitations(problem, _candidate(coordinates, rng), weight)
        for _ in range(GUESSED_CANDIDATES if coordinates.guessed.any() else CANDIDATES)
    ]
    misfits = np.array([problem.chi_square(theta, weight) for theta in candidates])
    return candidates[int(np.argmin(np.where(np.isfinite(misfits), misfits, np.inf)))]


def _candidate(coordinates: Coordinates, rng: np.random.Generator) -> Floats:
    """Draw coefficients around the expected ones; those that nobody knows share a common factor besides."""
    common = {quantity: GUESSED_SPREAD * rng.standard_normal() for quantity in sorted(set(coordinates.quantities))}
    theta = coordinates.centre.copy()
    for k, (quantity, direct) in enumerate(zip(coordinates.quantities, coordinates.logarithmic, strict=True)):
        own = (START_SPREAD_LOG if direct else START_SPREAD_CROSS) * rng.standard_normal()
        for place in coordinates.places(k):
            # Nowhere farther from the centre than the prior believes.
            step = min(1.0, coordinates.spread[place]) * own
            theta[place] = coordinates.centre[place] + step + (common[quantity] if coordinates.guessed[k] else 0.0)
    return theta
