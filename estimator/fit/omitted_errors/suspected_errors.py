"""Errors that a document does not have and that may explain a refused fit, as its score tells them.

Of one channel's gain and run-out, of two channels', or of all couplings' run-outs: the score test says to first order by how
much χ² would fall (Rao, Proc. Camb. Phil. Soc. 44 (1948) 50, doi:10.1017/S0305004100023987). Of large errors that is far off,
but it still tells which to try first: another's fit takes as long as it takes to find that it leads nowhere, or explains the
data by accident.
"""

from collections.abc import Mapping, Sequence
from itertools import combinations
from operator import itemgetter
from typing import TypeVar

import numpy as np
from msgspec import Struct

from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.fit.validation.channel_sensitivity import ChannelEffects, channel_effects
from estimator.fit.validation.goodness_of_fit import judge
from estimator.machine.parameter_description import describe

_T = TypeVar("_T")
LEAST_PART = 0.5
"""Part of what χ² is above its degrees of freedom that a channel must explain to first order to be tried [-]."""


class SuspectedErrors(Struct, frozen=True):
    """Errors that may explain a refused fit.

    Attributes:
        channels: Places of the channels that explain much, that which explains most first.
        pairs: Places of two channels that explain much together, those first that explain most.
        couplings_first: Whether the couplings explain more than any of these.
    """

    channels: list[int]
    pairs: list[tuple[int, int]]
    couplings_first: bool


def suspected_errors(problem: FitProblem, refused: FitResult) -> SuspectedErrors:
    """Find which errors would explain a refused fit best, to first order.

    Source: Rao (1948, doi:10.1017/S0305004100023987).

    Args:
        problem: The fit's problem.
        refused: The fit.

    Returns:
        The errors.
    """
    effects = channel_effects(problem, refused)
    about = [describe(name) for name in effects.names]
    of_couplings = _fall(effects, [place for place, of in enumerate(about) if of.element_kind == "coupling"])
    places = _places_by_channel(effects, problem.train.channels)
    alone = {channel: _fall(effects, own) for channel, own in places.items()}
    together = {
        (one, other): _fall(effects, places[one] + places[other])
        for one, other in combinations(places, 2)
        if alone[one] > 0.0 and alone[other] > 0.0
    }
    least = LEAST_PART * (refused.chi_square - judge(problem, refused).degrees_of_freedom)
    channels = _largest(alone, least)
    return SuspectedErrors(
        channels=channels,
        pairs=_largest(together, least),
        couplings_first=of_couplings > max((alone[one] for one in channels), default=0.0),
    )


def clearest_other(effects: ChannelEffects, channels: Sequence[str], *, beside: Sequence[int], least: float) -> int | None:
    """Find the channel whose errors explain most of what a fit with errors of other channels leaves over, to first order.

    Source: Rao (1948, doi:10.1017/S0305004100023987).

    Args:
        effects: Effects of the errors about that fit.
        channels: Ids of the m channels.
        beside: Places of the channels whose errors are free.
        least: Fall of χ² from which on a channel counts [-].

    Returns:
        Place of the channel; None where none explains as much.
    """
    places = _places_by_channel(effects, channels)
    free = [place for channel in beside for place in places[channel]]
    falls = {one: _fall(effects, own + free) for one, own in places.items() if one not in beside and own}
    return next(iter(_largest(falls, least)), None)


def _places_by_channel(effects: ChannelEffects, channels: Sequence[str]) -> dict[int, list[int]]:
    about = [describe(name) for name in effects.names]
    return {channel: [place for place, of in enumerate(about) if of.channel == name] for channel, name in enumerate(channels)}


def _largest(falls: Mapping[_T, float], least: float) -> list[_T]:
    """Return what makes χ² fall by something, and by the least that counts at least; what does most first."""
    return [one for one, fall in sorted(falls.items(), key=itemgetter(1), reverse=True) if fall > 0.0 and fall >= least]


def _fall(effects: ChannelEffects, places: list[int]) -> float:
    """Return by how much χ² would fall with some errors [-]; 0 where there are none, or nothing is known of one."""
    information, score = effects.information[np.ix_(places, places)], effects.score[places]
    size = np.sqrt(np.diag(information))
    if not places or not np.all(size > 0.0):  # of a channel without phasors nothing is known
        return 0.0
    change = np.linalg.lstsq(information / np.outer(size, size), score / size)[0]
    return float(change @ (score / size))
