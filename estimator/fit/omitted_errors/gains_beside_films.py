"""Estimates of an accepted fit on oil films with the gains that are clearly off.

The score names the channel to first order only. So the clearest ones are tried, and the one that leaves least over is taken
(the likelihoods' ratio, with the priors); then a second one likewise, where one is still clearly off. Where two explain the
data nearly as well, as both probes of a bearing do on trains that are soft beside their films, both are free, so that the
estimates are as uncertain as not knowing which leaves them. What widens a fit's intervals is looked for anew there. These are
the estimates that the identification tells, so that histories, tables and alerts have the same number for the same thing.
"""

from collections.abc import Collection, Sequence

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from estimator.arrays import Floats
from estimator.fit.omitted_errors.explained_fit import own_covariance
from estimator.fit.omitted_errors.open_errors import about_open_errors, errors_found_along, with_open_errors
from estimator.fit.omitted_errors.open_gains import CLEAR_FALL, FitWithGains, GainError, clear_gains, cost, fit_with_gains
from estimator.fit.optimisation.nuisance_parameters import deviates_too_far
from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.fit.validation.channel_sensitivity import ChannelEffects, channel_effects
from estimator.fit.validation.interval_widths import IntervalWidths, interval_widths
from estimator.machine.parameter_description import describe

TRIED = 3
"""Channels that are tried, those whose gains explain most to first order."""
MOST_GAINS = 4
"""Gains of one run that are free at most: of two probes that are off, with their rivals."""
RIVAL = 9.0
"""Excess of χ² and the prior's cost of a gain over those of the best one beneath which either may be off [-]: three standard
deviations."""


class EstimatesWithErrors(Struct, frozen=True, eq=False):
    """Estimates of an accepted fit of n coordinates with gains that are clearly off, and errors that a diagnosis has named.

    Attributes:
        theta: Values (n,) of the fit coordinates [-].
        widths: Widths of their intervals, as uncertain as the errors leave them.
        effects: Effects of e errors, about the estimates with these errors being what they are.
        words: What is said of the errors, behind the verdict.
    """

    theta: Floats
    widths: IntervalWidths
    effects: ChannelEffects
    words: str


def estimates_with_errors(
    problem: FitProblem,
    found: FitResult,
    widths: IntervalWidths,
    effects: ChannelEffects,
    clear: Sequence[GainError],
    open_errors: Collection[str] = (),
) -> EstimatesWithErrors | None:
    """Compute the estimates of an accepted fit with the errors that are there, and the effects of errors about these.

    Source: Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, sec. 3.4.

    Args:
        problem: The fit's problem.
        found: The fit.
        widths: Widths of its intervals.
        effects: Effects of e errors about it.
        clear: Gains that are clearly off, that which explains most first.
        open_errors: Errors that a diagnosis has named, such as `probe.B1L.gain`.

    Returns:
        The estimates; None where no error is named, and no gain explains as much as the score has said, or only with films
        unlike the document's.
    """
    told = _with_gains(problem, found, clear)
    if told is not None:
        best, widths, effects = told
        about, words = _at_gains(problem, best, widths), _words([problem.train.channels[one] for one in sorted(best.channels)])
    else:
        own = problem.coordinates
        about, words = (own.point(found.theta), widths.covariance * np.outer(own.unit, own.unit)), ""
    found_along, channels = errors_found_along(effects), problem.train.channels
    named = [place for place, name in enumerate(effects.names) if describe(name).whole in open_errors]
    if set(named) - set(found_along):
        effects = about_open_errors(*about, effects, sorted({*found_along, *named}), channels=channels)
        about = effects.estimate(*about)
        words += f"; estimates leave open what a diagnosis has named: {', '.join(sorted(open_errors))}"
    return _estimates(problem, about, widths, effects, words) if words else None


def _with_gains(
    problem: FitProblem, found: FitResult, clear: Sequence[GainError]
) -> tuple[FitWithGains, IntervalWidths, ChannelEffects] | None:
    """Return the fit with the gains that are clearly off, the widths of its intervals, and the effects about it."""
    told, left = None, cost(problem, found)
    opened: tuple[int, ...] = ()
    start = found.theta
    while clear and len(opened) < MOST_GAINS:
        best = _best(problem, found, [(*opened, one.channel) for one in clear[:TRIED]], start)
        if best is None:
            break
        widths = interval_widths(best.problem, best.found)
        if left - best.cost < CLEAR_FALL * widths.inflation or widths.form.words or deviates_too_far(best.problem, best.found):
            break
        effects = _about(problem, best, widths)
        told = (best, widths, effects)
        left, opened, start = best.cost, best.channels, best.found.theta
        clear = clear_gains(problem, found, effects, least=CLEAR_FALL, beside=opened)
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


def _about(problem: FitProblem, best: FitWithGains, widths: IntervalWidths) -> ChannelEffects:
    """Return the effects of errors about a fit with gains, and its estimates with these being what they are."""
    point, covariance = _at_gains(problem, best, widths)
    told = channel_effects(problem, best.without(problem.coordinates.size), inflation=widths.inflation, at=best.gains)
    return replace(told, point=point, covariance=covariance)


def _at_gains(problem: FitProblem, best: FitWithGains, widths: IntervalWidths) -> tuple[Floats, Floats]:
    """Return the values (n,) of a fit with gains, and their covariance (n, n) with these being what they are [SI or 1]."""
    own = problem.coordinates
    index = np.arange(own.size)
    covariance = own_covariance(own, best.found, inflation=widths.inflation)
    wider = widths.besides[np.ix_(index, index)] * np.outer(own.unit, own.unit)
    return own.point(best.without(own.size).theta), covariance + (wider + wider.T) / 2


def _estimates(
    problem: FitProblem, about: tuple[Floats, Floats], widths: IntervalWidths, effects: ChannelEffects, words: str
) -> EstimatesWithErrors:
    """Return what is told of a fit with errors: estimates as uncertain as these leave them."""
    own = problem.coordinates
    point, covariance = with_open_errors(*about, effects, errors_found_along(effects), channels=problem.train.channels)
    return EstimatesWithErrors(
        theta=own.theta(point),
        widths=widths.of_first(own.size, covariance=covariance / np.outer(own.unit, own.unit)),
        effects=effects,
        words=words,
    )


def _words(names: Sequence[str]) -> str:
    """Return what is said of gains. Which one is off, and by how much, is for a diagnosis of several runs to tell."""
    if len(names) == 1:
        return f"; probe {names[0]} clearly has another gain than the document says: estimates allow for that"
    return (
        f"; of the probes {', '.join(names)} one at least clearly has another gain than documented: estimates allow for that"
    )
