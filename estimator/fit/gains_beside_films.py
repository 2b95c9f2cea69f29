"""Estimates of an accepted fit on oil films with the gains that are clearly off.

The score names the channel to first order only. So the clearest ones are tried, and the one that leaves least over is taken
(the likelihoods' ratio, with the priors); then a second one likewise, where one is still clearly off. Where two explain the
data nearly as well, as both probes of a bearing do on trains that are soft beside their films, both are free, so that the
estimates are as uncertain as not knowing which leaves them. What widens a fit's intervals is looked for anew there.
"""

from collections.abc import Callable, Sequence

import numpy as np
from msgspec.structs import replace

from estimator.arrays import Floats
from estimator.fit.explained_fit import own_covariance
from estimator.fit.open_gains import CLEAR_FALL, FitWithGains, GainError, clear_gains, cost, fit_with_gains
from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.fit.validation.channel_sensitivity import ChannelEffects, channel_effects

TRIED = 3
"""Channels that are tried, those whose gains explain most to first order."""
MOST_GAINS = 4
"""Gains of one run that are free at most: of two probes that are off, with their rivals."""
RIVAL = 9.0
"""Excess of χ² and the prior's cost of a gain over those of the best one beneath which either may be off [-]: three standard
deviations."""
Widening = Callable[[FitProblem, FitResult], tuple[float, Floats]]
"""Function that returns the factor by which the covariance of a fit is widened [-], and what is added besides (n, n) [-]."""


def effects_with_gains(
    problem: FitProblem, found: FitResult, clear: Sequence[GainError], widening: Widening
) -> ChannelEffects | None:
    """Compute the estimates with the gains that are clearly off, and the effects of errors about these.

    Source: Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, sec. 3.4.

    Args:
        problem: The fit's problem.
        found: The fit.
        clear: Gains that are clearly off, that which explains most first.
        widening: Function that says how intervals are widened.

    Returns:
        Effects of e errors; None where no gain explains as much as the score has said.
    """
    told, left = None, cost(problem, found)
    opened: tuple[int, ...] = ()
    start = found.theta
    while clear and len(opened) < MOST_GAINS:
        best = _best(problem, found, [(*opened, one.channel) for one in clear[:TRIED]], start)
        if best is None:
            break
        factor, besides = widening(best.problem, best.found)
        if left - best.cost < CLEAR_FALL * factor:
            break
        told = _about(problem, best, factor, besides)
        left, opened, start = best.cost, best.channels, best.found.theta
        clear = clear_gains(problem, found, told, least=CLEAR_FALL, beside=opened)
    return told


def _best(problem: FitProblem, found: FitResult, every: Sequence[tuple[int, ...]], start: Floats) -> FitWithGains | None:
    """Return the best fit with gains of some channels; with those of its rival, too, where one explains nearly as much."""
    tried = [fit for one in every if (fit := fit_with_gains(problem, found, one, start=start)) is not None]
    ordered = sorted(tried, key=lambda one: one.cost)
    near = [one for one in ordered[1:] if one.cost - ordered[0].cost < RIVAL and len(one.channels) < MOST_GAINS]
    if near:
        best, rival = ordered[0], near[0]
        together = fit_with_gains(problem, found, (*best.channels, rival.channels[-1]), start=best.found.theta)
        return best if together is None else together
    return ordered[0] if ordered else None


def _about(problem: FitProblem, best: FitWithGains, factor: float, besides: Floats) -> ChannelEffects:
    own = problem.coordinates
    there, index = best.without(own.size), np.arange(own.size)
    covariance = own_covariance(own, best.found, inflation=factor)
    wider = besides[np.ix_(index, index)] * np.outer(own.unit, own.unit)
    told = channel_effects(problem, there, inflation=factor, at=best.gains)
    return replace(told, point=own.point(there.theta), covariance=covariance + (wider + wider.T) / 2)
