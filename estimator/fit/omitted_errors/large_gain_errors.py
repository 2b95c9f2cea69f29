"""Effects of channels' errors where a channel's gain is far from what the document says.

Score and information tell of a gain to first order (`channel_sensitivity`). One that is off by a fifth moves a fit without it
so far that the second order counts: what it leaves over looks like a change of a coupling or a bearing. So where a gain is
clearly off the fit is done again with it, from its end, and everything is linearised there (Gaussian approximation of the
likelihood at its maximum; Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, sec. 3.4). The fit itself
stays as it is: what it leaves out moves it from there to its own along the secant between both. Estimates of an accepted fit
on oil films allow for the gain instead (`gains_beside_films`).
"""

from collections.abc import Sequence

import numpy as np
from msgspec.structs import replace

from estimator.arrays import Floats
from estimator.fit.omitted_errors.open_gains import CLEAR_FALL, GainError, clear_gains, fit_with_gains
from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.fit.validation.channel_sensitivity import ChannelEffects, channel_effects


def channel_effects_at_large_gain(problem: FitProblem, found: FitResult) -> ChannelEffects:
    """Compute the effects of errors of channels, beyond first order of a gain that is clearly off (module's docstring).

    Source: Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, sec. 3.4.

    Args:
        problem: The fit's problem.
        found: The fit.

    Returns:
        Effects of e errors, about the fit's own point.
    """
    effects = channel_effects(problem, found)
    return along_secant(problem, found, effects, clear_gains(problem, found, effects, least=CLEAR_FALL))


def along_secant(
    problem: FitProblem, found: FitResult, effects: ChannelEffects, clear: Sequence[GainError], *, inflation: float = 1.0
) -> ChannelEffects:
    """Return effects of errors beyond first order of the gain that is most clearly off.

    Calibrated fits and those that have given up a channel are told to first order, as are all without such a gain.

    Source: Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, sec. 3.4.

    Args:
        problem: The fit's problem.
        found: The fit.
        effects: Effects of e errors to first order.
        clear: Gains that are clearly off, that which explains most first.
        inflation: Factor by which the fit's covariance was widened [-].

    Returns:
        Effects of e errors, about the fit's own point; the given ones where no gain is clearly off.
    """
    again, own = fit_with_gains(problem, found, (clear[0].channel,)) if clear else None, problem.coordinates
    if again is None or again.found.misfit >= found.misfit:
        return effects
    told = channel_effects(problem, again.without(own.size), inflation=inflation, at=again.gains)
    return _about(
        told, own.unit * (found.theta - again.found.theta[: own.size]), clear[0].places, again.found.theta[own.size :]
    )


def _about(told: ChannelEffects, moved: Floats, places: list[int], gain: Floats) -> ChannelEffects:
    """Return effects that were linearised at a gain about the point (n,) of the fit without it, which lies `moved` from there.

    The likelihood has the same maximum and the same curvature among the errors; the way there is the secant.
    """
    bias = told.bias.copy()
    bias[:, places] += np.outer(moved - bias[:, places] @ gain, gain) / (gain @ gain)
    at = np.zeros(len(told.names))
    at[places] = gain
    return replace(told, bias=bias, score=told.score + told.information @ at, at=None)
