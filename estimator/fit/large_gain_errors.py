"""Effects of channels' errors where a channel's gain is far from what the document says.

Score and information tell of a gain to first order (`channel_sensitivity`). One that is off by a fifth moves a fit without it
so far that the second order counts: what it leaves over looks like a change of a coupling or a bearing. So where a gain is
clearly off the fit is done again with it, from its end, and everything is linearised there (Gaussian approximation of the
likelihood at its maximum; Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, sec. 3.4). The fit itself
stays as it is. Of an accepted one on oil films the effects hold the estimates with that gain, too, which are what a diagnosis
goes by (`gains_beside_films`); what a refused one leaves out moves it from there to its own along the secant between both.
"""

import numpy as np
from msgspec.structs import replace

from estimator.arrays import Floats
from estimator.fit.gains_beside_films import Widening, effects_with_gains
from estimator.fit.open_gains import CLEAR_FALL, clear_gains, fit_with_gains
from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.fit.validation.channel_sensitivity import ChannelEffects, channel_effects


def channel_effects_at_large_gain(
    problem: FitProblem, found: FitResult, *, inflation: float = 1.0, widening: Widening | None = None
) -> ChannelEffects:
    """Compute the effects of errors of channels, beyond first order of a gain that is clearly off (module's docstring).

    Calibrated fits and those that have given up a channel are told to first order, as are all without such a gain.

    Source: Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, sec. 3.4.

    Args:
        problem: The fit's problem.
        found: The fit.
        inflation: Factor by which the fit's covariance was widened [-]; the information and the score are divided by it.
        widening: Function that says how an accepted fit is widened; None of a refused one.

    Returns:
        Effects of e errors, about the fit's own point; of an accepted fit on oil films about that with the gains.
    """
    effects, own = channel_effects(problem, found, inflation=inflation), problem.coordinates
    clear = clear_gains(problem, found, effects, least=CLEAR_FALL / inflation)
    if not clear:
        return effects
    # Of constant coefficients the secant tells more of a small drift: with the estimates at the gain, a coupling is told too.
    if widening is not None and own.nuisance.any():
        return effects_with_gains(problem, found, clear, widening) or effects
    again = fit_with_gains(problem, found, (clear[0].channel,))
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
