"""Fit of a train's response from one start: maximum likelihood with a weak prior.

Output error: the residual is measured minus modelled response, weighted by its measurement error, so that noise does not
bias the estimate (an equation-error regression, thesis Eq. 4.71, puts noise into the regressors). Levenberg-Marquardt with
exact sensitivities (Marquardt, J. SIAM 11 (1963) 431, doi:10.1137/0111030), in the coordinates of `coordinates`; in curved
valleys with geodesic acceleration (Transtrum, Machta and Sethna, Phys. Rev. E 83 (2011) 036701,
doi:10.1103/PhysRevE.83.036701). Weights sharpen in stages: the first stages allow a relative misfit beside the noise, which
flattens the valleys that a shifted resonance leaves, the last has the noise alone. Then weights are taken from the fitted
response, phasors that cannot be noise are left out and the noise is estimated where it is not known, again and again until
nothing changes: iteratively reweighted least squares, whose fixed point solves the likelihood equations of Gaussian errors
with weights taken as known.
"""

import math
from collections.abc import Sequence
from functools import singledispatch

import numpy as np

from estimator.arrays import Floats
from estimator.fit.optimisation.nuisance_parameters import counted_by_effect
from estimator.fit.optimisation.reweighting import is_unchanged, with_estimated_noise, without_outliers
from estimator.fit.problem.fit_problem import FitProblem, FitResult, best_excitations
from estimator.fit.problem.gap_rows import gap_cost
from estimator.phasors.noise import outlier_limit
from estimator.rotor.elimination import SingularCondensation

STAGE_MISFITS = (0.5, 0.05, 0.0)
"""Relative misfit allowed beside the noise in each stage [-]."""
STAGE_ITERATIONS = (40, 40, 80)
"""Most steps in each stage."""
FINAL_PASSES = 8
"""Most repetitions of the last stage with weights, outliers and noise from the response just fitted."""
STEP_LIMIT = 1.0
"""Largest change of a coordinate in one step [-]: a factor e of a direct term."""
CONVERGED_DECREASE = 1e-3
"""Decrease of χ² promised by a full Newton step below which a stage ends [-]; a change of 1 is one standard error."""
FIRST_DAMPING = 1e-3
"""Part of the curvature's diagonal that is added to it in a first step [-]."""
NEAR_DAMPING = 1e-6
"""Part that is added in the first step from the end of others [-]."""
CURVED = 0.75
"""Part of the decrease that a step has promised [-]; where it brings less, the next follows the bend of the valley."""
BEND_PART = 0.1
"""Part of a step over which the bend of the phasors is looked at [-]."""
LARGEST_BEND = 0.75
"""Twice the acceleration over the step up to which a step is bent [-] (Transtrum, Machta and Sethna 2011)."""
LARGEST_DAMPING = 1e10
"""Damping from which on steps are too short to bring anything [-]."""
SMALLEST_SHARE = 0.3
"""Smallest part of a Newton step that is taken where the last one went too far [-]."""
PASSING_DECREASE = 1.0
"""Decrease at which stages from an earlier fit's end pass to the next [-]: their weights are not yet those of the end."""
STALLED_STEPS = 12
"""Number of steps over which the decrease of χ² is watched where derivatives promise more than steps bring."""
STALLED_DECREASE = 0.05
"""Decrease of χ² over that many steps below which a stage ends [-]."""
STAGES = tuple(zip(STAGE_MISFITS, STAGE_ITERATIONS, strict=True))
"""Stages of a fit: misfit that weights allow for [-], and most iterations."""
HOPELESS_MISFIT = 3.0
"""χ²/dof from which on a fit leads nowhere [-]: after the coarse stages, and where steps at their pace do not come below it.

A model that is right leaves less than 1 after coarse stages, since these allow five per cent of misfit beside the noise.
"""
STALLED_PROMISE = 5.0
"""Decrease of χ² that a full Newton step may promise where a stage ends so [-]: the end of the valley is within some two
standard errors."""


def fit(
    problem: FitProblem,
    start: Floats,
    *,
    near: bool = False,
    give_up_from: float = math.inf,
    passes: int = FINAL_PASSES,
) -> FitResult:
    """Fit from one start (Marquardt 1963, doi:10.1137/0111030; method in the module's docstring).

    Args:
        problem: Data, train and coordinates.
        start: Fit coordinates θ (n,) to start from [-].
        near: Whether the start is an earlier fit's end, which needs no coarse stages.
        give_up_from: χ²/dof after the coarse stages from which on the start is given up [-].
        passes: Most repetitions of the last stage; none is needed where weights and outliers stay as they are.

    Returns:
        End of the fit.
    """
    theta, iterations, converged = start, 0, False
    problem, measured, stages = _near(problem, start) if near else (problem, problem.first_amplitude, STAGES)
    settled = PASSING_DECREASE if near and passes else CONVERGED_DECREASE
    coarse_misfit, told = math.nan, theta.size - int(np.count_nonzero(counted_by_effect(problem.coordinates)))
    for misfit, limit in stages:
        weight = problem.weight(measured, misfit)
        freedom = max(1, 2 * int(np.count_nonzero(problem.used)) - told)
        hopeless = math.inf if problem.noise.estimated else HOPELESS_MISFIT * freedom
        theta, converged, steps = descend(problem, theta, weight, limit, settled=settled, hopeless=hopeless)
        iterations += steps
        if misfit == STAGE_MISFITS[-2]:
            coarse_misfit = problem.chi_square(theta, weight) / freedom
            if coarse_misfit >= give_up_from:
                break
        problem = without_outliers(problem, theta, misfit)
    given_up = coarse_misfit >= give_up_from
    for _ in range(0 if given_up else passes):
        before = problem
        problem = without_outliers(with_estimated_noise(problem, theta), theta, 0.0)
        weight = problem.weight(np.abs(problem.model(theta)), 0.0)
        beginning = problem.chi_square(theta, weight)
        theta, converged, steps = descend(problem, theta, weight, limit, damping=NEAR_DAMPING, hopeless=hopeless)
        iterations += steps
        # What ends in a curved valley ends there again.
        ended = steps == 0 or (steps >= STALLED_STEPS and beginning - problem.chi_square(theta, weight) < STALLED_DECREASE)
        if not converged or (ended and is_unchanged(before, problem)):
            break
    chi_square, _, information = problem.linearised(theta, weight)
    return FitResult(
        theta=theta,
        chi_square=chi_square - gap_cost(problem.gaps, theta),
        information=information,
        converged=converged,
        iterations=iterations,
        noise=problem.noise,
        outlier=problem.outlier,
        misfit=math.inf if given_up else _misfit(problem, chi_square, weight),
        channel_noise=problem.channel_noise,
        coarse_misfit=coarse_misfit,
    )


def _near(problem: FitProblem, start: Floats) -> tuple[FitProblem, Floats, Sequence[tuple[float, int]]]:
    """Return the problem, the amplitudes of its weights and the stages for a start at an earlier fit's end.

    Weights and what is far too large or small are taken from that fit, so that outliers do not lead away from it.
    """
    without = without_outliers(problem, start, STAGE_MISFITS[-2])
    return without, np.abs(problem.model(start)), STAGES[-2:] if without.outlier.any() else STAGES[-1:]


def _misfit(problem: FitProblem, chi_square: float, weight: Floats) -> float:
    whole = chi_square + 2.0 * outlier_limit(problem.measurement.usable) * np.count_nonzero(problem.outlier)
    if not problem.noise.estimated:
        return float(whole)
    return float(whole * np.exp(-2.0 * np.mean(np.log(weight[problem.used & (weight > 0.0)]))))


def descend(
    problem: FitProblem,
    theta: Floats,
    weight: Floats,
    limit: int,
    *,
    damping: float = FIRST_DAMPING,
    settled: float = CONVERGED_DECREASE,
    hopeless: float = math.inf,
) -> tuple[Floats, bool, int]:
    """Run Marquardt's method (doi:10.1137/0111030) at fixed weights, damped by Nielsen's gain ratio (IMM-REP-1999-05).

    Args:
        problem: The problem.
        theta: Fit coordinates θ (n,) to start from [-].
        weight: Weights (S, m) [1/m].
        limit: Most steps.
        damping: Part of the curvature's diagonal that is added to it in the first step [-].
        settled: Decrease of χ² promised by a full Newton step below which it ends [-].
        hopeless: χ² of phasors below which the steps left must come at the pace of the last ones for it to go on [-].

    Returns:
        θ (n,) [-], whether it converged, and the number of steps tried.
    """
    prior, growth, gain, share = problem.coordinates.prior, 2.0, 1.0, 1.0
    data, gradient, curvature = problem.linearised(theta, weight)
    cost = data + prior.cost(theta)
    if not np.isfinite(cost):
        return theta, False, 0  # a start in which a film is too thin has no slope to follow
    costs = [cost]
    for step_number in range(limit):
        slope = gradient - prior.pull(theta)
        hessian = curvature + prior.precision
        promise = float(slope @ np.linalg.solve(hessian, slope))
        beside = prior.cost(theta) + gap_cost(problem.gaps, theta)
        ended = promise < settled or _has_stalled(costs, promise)
        if ended or _leads_nowhere(costs, promise, limit - step_number, hopeless + beside):
            return theta, ended, step_number
        damped = np.asarray(hessian + damping * np.diag(np.diag(hessian)), dtype=float)
        step = np.linalg.solve(damped, slope)
        share = min(share, STEP_LIMIT / max(float(np.max(np.abs(step))), 1e-300))
        step *= share
        promised = float(2 * slope @ step - step @ hessian @ step)
        try:  # nearly all trials are taken, so their derivatives are computed at once
            trial = bent(problem, theta, weight, step, damped) if gain < CURVED else theta + step
            trial_data, trial_gradient, trial_curvature = problem.linearised(trial, weight)
            trial_cost = trial_data + prior.cost(trial)
        except SingularCondensation:
            trial_cost = math.inf  # E or density went where a speed cannot be condensed at: a shorter step
        gain = (cost - trial_cost) / promised
        share = _next_share(share, float(slope @ step), trial_cost - cost)
        if np.isfinite(trial_cost) and gain > 1e-4:
            theta, cost, gradient, curvature = trial, trial_cost, trial_gradient, trial_curvature
            damping, growth = max(damping * max(0.2, 1.0 - (2.0 * min(gain, 1.0) - 1.0) ** 3), 1e-9), 2.0
        else:
            damping, growth = max(damping, 1e-6) * growth, 2.0 * growth
        costs.append(cost)
        if damping > LARGEST_DAMPING:
            return theta, False, step_number + 1  # what steps could bring lies where no film carries
    return theta, False, limit


def _next_share(share: float, descent: float, change: float) -> float:
    """Return the most of the next Newton step that is taken: to the lowest point of the parabola over the last one.

    Where residuals bend the valley, Gauss and Newton's curvature is too small, and whole steps swing from side to side
    (interpolation as in Nocedal and Wright, Numerical Optimization, 2006, sec. 3.5). When it has ended is judged by what a
    whole step promises all the same.

    share: part taken last [-]; descent: half the decrease that the slope promises over that part [-]; change: of the cost [-].
    """
    rise = change + 2.0 * descent
    return float(np.clip(share * descent / rise, SMALLEST_SHARE, 1.0)) if np.isfinite(rise) and rise > 0.0 else 1.0


@singledispatch
def bend(problem: FitProblem, theta: Floats, step: Floats, weight: Floats) -> Floats:
    """Compute the second derivative of the weighted phasors along a step, projected on their derivatives.

    From a difference over a part of the step (Transtrum, Machta and Sethna 2011, doi:10.1103/PhysRevE.83.036701).

    Args:
        problem: The problem.
        theta: Fit coordinates θ (n,) [-].
        step: Step (n,) [-].
        weight: Weights (S, m) [1/m].

    Returns:
        Projection (n,) [-]; not finite where there is no model so far along the step.
    """
    weight = np.where(problem.used, weight, 0.0)
    beyond = problem.model(theta + BEND_PART * step)
    found = np.zeros(theta.size)
    for one in problem.linear_phasors(theta):
        rows, difference = one.weighted(beyond, weight)
        found += rows @ (2.0 / BEND_PART * (difference / BEND_PART - step @ rows))
    return found


def bent(problem: FitProblem, theta: Floats, weight: Floats, step: Floats, damped: Floats) -> Floats:
    """Follow a curved valley over a step.

    With geodesic acceleration (Transtrum, Machta and Sethna 2011, doi:10.1103/PhysRevE.83.036701) and the excitations that fit
    best there: most of the bend is that of their product with everything else (variable projection; Golub and Pereyra 1973,
    doi:10.1137/0710036).

    Args:
        problem: The problem.
        theta: Fit coordinates θ (n,) [-].
        weight: Weights (S, m) [1/m].
        step: The straight step (n,) [-].
        damped: Curvature (n, n) with damping from which it was found [-].

    Returns:
        θ (n,) at the end of the step [-].

    Raises:
        SingularCondensation: E or density went where a speed cannot be condensed at.
    """
    acceleration = -np.linalg.solve(damped, bend(problem, theta, step, weight))
    size = np.sqrt(np.diag(damped))
    if 2.0 * np.linalg.norm(size * acceleration) <= LARGEST_BEND * np.linalg.norm(size * step):
        step = step + acceleration / 2.0
    return best_excitations(problem, theta + step, weight)


def _leads_nowhere(costs: list[float], promise: float, left: int, hopeless: float) -> bool:
    """Return whether steps at the pace of the last ones end above a χ², far from any end of their own."""
    if len(costs) <= STALLED_STEPS or promise <= STALLED_PROMISE:
        return False
    pace = (costs[-1 - STALLED_STEPS] - costs[-1]) / STALLED_STEPS
    return costs[-1] - left * pace > hopeless


def _has_stalled(costs: list[float], promise: float) -> bool:
    """Return whether the steps of a stage bring nothing more, close to its end: in a valley that curves."""
    if len(costs) <= STALLED_STEPS or promise > STALLED_PROMISE:
        return False
    return costs[-1 - STALLED_STEPS] - costs[-1] < STALLED_DECREASE
