"""Starts of a fit: the nominal values, then the best of random candidates around them, until starts agree."""

import math
from collections.abc import Callable

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from estimator.arrays import Floats
from estimator.fit.optimisation.maximum_likelihood import FINAL_PASSES, HOPELESS_MISFIT, STAGE_MISFITS, fit
from estimator.fit.problem.coordinates import Coordinates
from estimator.fit.problem.fit_problem import FitProblem, FitResult, best_excitations
from estimator.fit.problem.narrowed_prior import narrowed

START_SPREAD_LOG = 0.35
"""Standard deviation of the logarithm of a direct term in a random start [-]."""
START_SPREAD_CROSS = 0.35
"""Standard deviation of a cross-coupled term in a random start, in units of its element's direct terms [-]."""
AGREEING_STARTS = 3
"""Number of starts that must end in the same misfit for it to be believed."""
SAME_MISFIT = 1.01
"""Factor up to which two misfits are the same [-]."""
SAME_OPTIMUM = 1.0
"""Difference of χ² up to which two starts have ended in the same optimum [-]: a part of one standard error."""
MOST_CONTINUED = 2
"""Most times that a fit goes on in the valley in which it has not converged."""
CANDIDATES = 12
"""Number of random candidates from which each start after the first is the best."""
HELD_FACTOR = 10.0
"""Factor by which spreads are smaller in a fit that is held near the document's values [-]."""
GUESSED_CANDIDATES = 60
"""Number of random candidates where the document leaves nominal values out."""
GUESSED_SPREAD = 1.5
"""Standard deviation of the logarithm of the factor that all unknown direct terms of a kind share in a candidate [-]."""

Completion = Callable[[FitProblem, Floats, Floats], Floats]
"""Function of a problem, θ (n,) and weights (S, m) that returns the θ (n,) to start from."""


class FitFailed(ValueError):
    """Raised when no start leads to a finite misfit."""


class BestFit(Struct, frozen=True):
    """Best of several starts.

    Attributes:
        fit: The best fit.
        starts: Number of starts tried.
        iterations: Number of steps spent in all of them.
        unique: Whether the best optimum was found twice; None where that was not asked for.
    """

    fit: FitResult
    starts: int
    iterations: int
    unique: bool | None = None

    @property
    def remarks(self) -> tuple[str, ...]:
        """Return the remark that the best optimum may not be the best there is, where it was found once only."""
        if self.unique is not False:
            return ()
        return (f"the best of {self.starts} starts was reached once only: whether there is a better one is open",)


def best_fit(
    problem: FitProblem,
    *,
    starts: int,
    seed: int,
    good: Callable[[FitResult], bool],
    unfinished: Callable[[FitResult], bool] = lambda _: False,
    beginning: Floats | None = None,
    twice: bool = False,
    passes: int = FINAL_PASSES,
    begin: Completion = best_excitations,
    held_first: bool = False,
) -> BestFit:
    """Fit from start after start until one is good, or several agree that it gets no better, or `starts` are spent.

    The first good one need not be the best: with `twice` it goes on until the best has been reached by two starts.

    Args:
        problem: Data, train and coordinates.
        starts: Most starts.
        seed: Seed of the random starts.
        good: Function that accepts a fit.
        unfinished: Function that returns whether a fit would be good had it converged: it goes on from where it is.
        beginning: Fit coordinates θ (n,) of the first start, in place of the nominal values [-].
        twice: Whether to go on until the best misfit has been reached twice.
        passes: Most repetitions of each fit's last stage.
        begin: Function that completes the coefficients of a start by what follows from them linearly.
        held_first: Whether the first start is held near the nominal values, unless two must agree (`_held_near_document`).

    Returns:
        The best fit.

    Raises:
        FitFailed: No start leads to a finite misfit.
    """
    rng = np.random.default_rng(seed)
    best, give_up_from, iterations = None, math.inf, 0
    reached: list[float] = []
    for start_number in range(1, max(1, starts) + 1):
        start, near = _start(problem, rng, start_number, beginning, begin, held_first=held_first and not twice)
        ended = fit(problem, start, near=near, give_up_from=give_up_from, passes=passes)
        found = ended if twice else _continued(problem, ended, unfinished, passes)
        iterations += found.iterations
        if not twice and np.isfinite(found.misfit) and good(found):
            best = found
            break
        if np.isfinite(found.misfit) and (best is None or found.misfit < best.misfit):
            best = found
        reached.append(found.misfit)
        if twice and best is not None and good(best) and _times(reached, best.misfit, SAME_OPTIMUM) >= 2:
            return BestFit(best, start_number, iterations, unique=True)
        # The first start from the document's values is always tried to its end.
        lost = found.coarse_misfit >= give_up_from and (beginning is None or start_number > 2)
        if np.isfinite(found.misfit) and found.coarse_misfit >= HOPELESS_MISFIT and not problem.noise.estimated:
            give_up_from = HOPELESS_MISFIT
        if best is not None and (_agree(reached, best) or (lost and _starts_are_near(problem))):
            break
    if best is None:
        raise FitFailed(f"none of {start_number} starts led to a finite misfit: are the document's values sensible?")
    return BestFit(best, start_number, iterations, _times(reached, best.misfit, SAME_OPTIMUM) >= 2 if twice else None)


def _start(
    problem: FitProblem,
    rng: np.random.Generator,
    number: int,
    beginning: Floats | None,
    begin: Completion,
    *,
    held_first: bool,
) -> tuple[Floats, bool]:
    """Return the start of a number, from 1 on, and whether it is another fit's end."""
    if beginning is not None:
        return (beginning, True) if number == 1 else (chosen_start(problem, rng, first=False, begin=begin), False)
    if held_first and number == 1 and not problem.coordinates.guessed.any():
        return _held_near_document(problem, chosen_start(problem, rng, first=True, begin=begin)), True
    return chosen_start(problem, rng, first=number == (2 if held_first else 1), begin=begin), False


def _held_near_document(problem: FitProblem, start: Floats) -> Floats:
    """Return where a fit ends that is held near the document's values: its spreads are smaller by a factor.

    Coefficients that follow the speed leave many directions open in which a fit with the document's own spreads may run far
    away into another optimum, such as one with absurd damping of a coupling.
    """
    return fit(replace(problem, coordinates=narrowed(problem.coordinates, HELD_FACTOR)), start, passes=1).theta


def _continued(problem: FitProblem, found: FitResult, unfinished: Callable[[FitResult], bool], passes: int) -> FitResult:
    """Return where a fit ends that goes on while it is unfinished, with the iterations of all."""
    iterations = found.iterations
    for _ in range(MOST_CONTINUED):
        if not np.isfinite(found.misfit) or not unfinished(found):
            break
        found = fit(problem, found.theta, near=True, passes=passes)
        iterations += found.iterations
    return replace(found, iterations=iterations)


def _agree(reached: list[float], best: FitResult) -> bool:
    """Return whether starts agree: the same misfit from everywhere is the data's or the model's, not the start's."""
    return _times(reached, best.misfit, (SAME_MISFIT - 1.0) * best.misfit) >= AGREEING_STARTS


def _starts_are_near(problem: FitProblem) -> bool:
    """Return whether further starts would end where the earlier ones did: priors place the films, and nothing is guessed."""
    return bool(problem.coordinates.nuisance.any() and not problem.coordinates.guessed.any())


def _times(reached: list[float], best: float, tolerance: float) -> int:
    """Return how often a misfit within a tolerance of the best was reached."""
    return sum(value - best < tolerance for value in reached)


def chosen_start(
    problem: FitProblem, rng: np.random.Generator, *, first: bool, begin: Completion = best_excitations
) -> Floats:
    """Choose the nominal values, else the best of some random candidates by their first-stage misfit.

    Args:
        problem: Data, train and coordinates.
        rng: Source of the candidates.
        first: Whether it is the first start, which begins at the nominal values where the document gives them.
        begin: Function that completes coefficients by what follows from them linearly.

    Returns:
        Fit coordinates θ (n,) [-].
    """
    coordinates = problem.coordinates
    weight = problem.weight(problem.first_amplitude, STAGE_MISFITS[0])
    if first and not coordinates.guessed.any():
        return begin(problem, coordinates.centre, weight)
    candidates = [
        begin(problem, _candidate(coordinates, rng), weight)
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
