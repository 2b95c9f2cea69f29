"""Outliers and noise of a fit, found anew from its residuals between its passes until neither changes."""

import numpy as np
from msgspec.structs import replace

from estimator.arrays import Floats
from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.phasors.noise import channel_noise, error_size, estimated_noise, outliers

SAME_NOISE = 0.01
"""Relative change of the estimated noise up to which it counts as unchanged [-]."""


def without_outliers(problem: FitProblem, theta: Floats, misfit: float) -> FitProblem:
    """Return the problem without the phasors that cannot be noise at θ.

    Args:
        problem: The problem.
        theta: Fit coordinates θ (n,) [-].
        misfit: Relative misfit allowed beside the noise [-].

    Returns:
        The problem with its outliers marked.
    """
    if not problem.robust:
        return problem
    model = problem.model(theta)
    size = np.abs(problem.measurement.phasor - model) * problem.weight(np.abs(model), misfit) / np.sqrt(2.0)
    if not problem.noise.estimated:
        return replace(problem, outlier=outliers(size, problem.measurement.usable))
    # A channel may be noisier than the others as long as nobody has said how noisy it is.
    each = [outliers(size[:, [c]], problem.measurement.usable[:, [c]]) for c in range(size.shape[1])]
    return replace(problem, outlier=np.concatenate(each, axis=1))


def with_estimated_noise(problem: FitProblem, theta: Floats) -> FitProblem:
    """Return the problem with the noise that the residuals at θ show, where the document asks for that.

    Args:
        problem: The problem.
        theta: Fit coordinates θ (n,) [-].

    Returns:
        The problem with that noise, or the same one.
    """
    modelled = problem.used & ~(problem.measurement.scatter > 0.0)
    if not problem.noise.estimated or not np.any(modelled):
        return problem
    model = problem.model(theta)
    spent = min(0.9, theta.size / (2 * np.count_nonzero(problem.used)))
    misfit = np.abs(problem.measurement.phasor - model)
    noise = estimated_noise(problem.noise, amplitude=np.abs(model)[modelled], misfit=misfit[modelled], spent=spent)
    error = error_size(noise, np.abs(model), np.full(misfit.shape, np.nan))
    size = np.divide(misfit, error, out=np.zeros_like(misfit), where=modelled & (error > 0.0))
    return replace(problem, noise=noise, channel_noise=channel_noise(size, modelled, spent=spent))


def with_fitted_noise(problem: FitProblem, found: FitResult) -> FitProblem:
    """Return the problem with the noise and the outliers of a fit.

    Args:
        problem: The problem.
        found: Its fit.

    Returns:
        The problem at the fit's end.
    """
    return replace(problem, outlier=found.outlier, noise=found.noise, channel_noise=found.channel_noise)


def is_unchanged(before: FitProblem, after: FitProblem) -> bool:
    """Check whether a pass has changed neither outliers nor noise.

    Args:
        before: The problem before the pass.
        after: The problem after it.

    Returns:
        Whether both are as they were.
    """
    return (
        np.array_equal(before.outlier, after.outlier)
        and np.allclose(before.channel_noise, after.channel_noise, rtol=3 * SAME_NOISE)
        and abs(after.noise.relative - before.noise.relative) <= SAME_NOISE * before.noise.relative
        and abs(after.noise.floor - before.noise.floor) <= SAME_NOISE * before.noise.floor
    )
