"""Errors that a document does not have and that may explain a refused fit, as its score tells them.

Of one channel's gain and run-out, or of all couplings' run-outs: the score test says to first order by how much χ² would fall
(Rao, Proc. Camb. Phil. Soc. 44 (1948) 50, doi:10.1017/S0305004100023987). Of large errors that is far off, but it still tells
which to try first: another's fit takes as long as it takes to find that it leads nowhere, or explains the data by accident.
"""

import numpy as np
from msgspec import Struct

from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.fit.validation.channel_sensitivity import ChannelEffects, channel_effects
from estimator.fit.validation.goodness_of_fit import judge
from estimator.machine.parameter_description import describe

LEAST_PART = 0.5
"""Part of what χ² is above its degrees of freedom that a channel must explain to first order to be tried [-]."""


class SuspectedErrors(Struct, frozen=True):
    """Errors that may explain a refused fit.

    Attributes:
        channels: Places of the channels that explain much, that which explains most first.
        couplings_first: Whether the couplings explain more than any of these.
    """

    channels: list[int]
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
    of_channels = [
        _fall(effects, [place for place, of in enumerate(about) if of.channel == name]) for name in problem.train.channels
    ]
    least = LEAST_PART * (refused.chi_square - judge(problem, refused).degrees_of_freedom)
    falls = sorted(((fall, place) for place, fall in enumerate(of_channels) if fall > 0.0 and fall >= least), reverse=True)
    return SuspectedErrors(
        channels=[place for _, place in falls],
        couplings_first=of_couplings > max((fall for fall, _ in falls), default=0.0),
    )


def _fall(effects: ChannelEffects, places: list[int]) -> float:
    """Return by how much χ² would fall with some errors [-]; 0 where there are none, or nothing is known of one."""
    information, score = effects.information[np.ix_(places, places)], effects.score[places]
    size = np.sqrt(np.diag(information))
    if not places or not np.all(size > 0.0):  # of a channel without phasors nothing is known
        return 0.0
    change = np.linalg.lstsq(information / np.outer(size, size), score / size)[0]
    return float(change @ (score / size))
