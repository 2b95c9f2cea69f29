"""Effects of channels' errors where one channel's gain is far from what the document says.

Score and information tell of a gain to first order (`channel_sensitivity`). One that is off by a fifth moves a fit without it
so far that the second order counts: what it leaves over looks like a change of a coupling or a bearing. So where a gain is
clearly off the fit is done again with it, from its end, and everything is linearised there (Gaussian approximation of the
likelihood at its maximum; Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, sec. 3.4). The fit itself
stays as it is. Of an accepted one on oil films the effects hold the estimates with that gain, too, which are what a diagnosis
goes by; what a refused one leaves out moves it from that point to its own along the secant between both.
"""

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from estimator.arrays import Floats
from estimator.fit.explained_fit import own_covariance
from estimator.fit.optimisation.maximum_likelihood import fit
from estimator.fit.optimisation.reweighting import with_fitted_noise
from estimator.fit.problem.channel_errors import UNIT_SPREAD, with_channel_errors
from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.fit.validation.channel_sensitivity import MOSTLY_LEFT_OUT, ChannelEffects, channel_effects
from estimator.fit.validation.goodness_of_fit import remark
from estimator.machine.parameter_description import COMPONENTS

CLEAR_FALL = 20.0
"""Fall of χ² with a gain from which on it is clearly off [-]: chance brings it once in 20,000 channels."""
LARGE_GAIN = 0.03
"""Part of itself by which a gain must be off for the second order to count [-]."""


class _GainError(Struct, frozen=True, eq=False):
    """Error of one channel's gain, to first order.

    Attributes:
        channel: Place of the channel.
        names: Names of both parts.
        places: Their places among the errors (2,).
        fall: Fall of χ² with it [-].
        size: Its magnitude [-].
    """

    channel: int
    names: tuple[str, ...]
    places: list[int]
    fall: float
    size: float


def channel_effects_at_large_gain(
    problem: FitProblem, found: FitResult, *, inflation: float = 1.0, accepted: bool = False
) -> ChannelEffects:
    """Compute the effects of errors of channels, beyond first order of the one gain that is clearly off (module's docstring).

    Calibrated fits and those that have given up a channel are told to first order, as are all without such a gain.

    Source: Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, sec. 3.4.

    Args:
        problem: The fit's problem.
        found: The fit.
        inflation: Factor by which the fit's covariance was widened [-]; the information and the score are divided by it.
        accepted: Whether the fit was accepted.

    Returns:
        Effects of e errors, about the fit's own point; of an accepted fit on oil films about that with the gain.
    """
    effects, own = channel_effects(problem, found, inflation=inflation), problem.coordinates
    clearest = _clearest(problem, found, effects)
    if clearest is None or clearest.fall * inflation < CLEAR_FALL or clearest.size < LARGE_GAIN:
        return effects
    behind = with_channel_errors(own, problem.train.channels, [("gain", clearest.channel)], spread=UNIT_SPREAD)
    free = with_fitted_noise(problem.with_channels(behind, found.theta), found)
    again = fit(free, np.concatenate([found.theta, np.zeros(len(clearest.names))]), near=True)
    if not again.converged or again.misfit >= found.misfit:
        return effects
    gain, there = again.theta[own.size :], replace(again, theta=again.theta[: own.size])
    at = dict(zip(clearest.names, gain.tolist(), strict=True))
    # Of constant coefficients the secant tells more of a small drift: with the estimates at the gain, a coupling is told too.
    if accepted and own.nuisance.any():
        widened = remark(replace(free, outlier=again.outlier), again).inflation
        told = channel_effects(problem, there, inflation=widened, at=at)
        return replace(told, point=own.point(there.theta), covariance=own_covariance(own, again, inflation=widened))
    told = channel_effects(problem, there, inflation=inflation, at=at)
    return _about(told, own.unit * (found.theta - there.theta), clearest.places, gain)


def _clearest(problem: FitProblem, found: FitResult, effects: ChannelEffects) -> _GainError | None:
    """Return the gain with which χ² would fall by the most (score test); none of a calibrated fit.

    None is asked where the fit has given up a channel: that one is at fault, and what it leaves over another's only in part.
    """
    usable = np.count_nonzero(problem.measurement.usable, axis=0)
    left_out = np.count_nonzero(found.outlier & problem.measurement.usable, axis=0)
    if problem.coordinates.calibrated is not None or np.any(left_out > MOSTLY_LEFT_OUT * usable):
        return None
    errors = []
    for channel, name in enumerate(problem.train.channels):
        names = tuple(f"probe.{name}.gain.{part}" for part in COMPONENTS)
        if names[0] not in effects.names or not usable[channel]:
            continue
        places = [effects.names.index(one) for one in names]
        gain = np.linalg.lstsq(effects.information[np.ix_(places, places)], effects.score[places])[0]
        errors.append(_GainError(channel, names, places, float(gain @ effects.score[places]), float(np.hypot(*gain))))
    return max(errors, key=lambda one: one.fall, default=None)


def _about(told: ChannelEffects, moved: Floats, places: list[int], gain: Floats) -> ChannelEffects:
    """Return effects that were linearised at a gain about the point (n,) of the fit without it, which lies `moved` from there.

    The likelihood has the same maximum and the same curvature among the errors; the way there is the secant.
    """
    bias = told.bias.copy()
    bias[:, places] += np.outer(moved - bias[:, places] @ gain, gain) / (gain @ gain)
    at = np.zeros(len(told.names))
    at[places] = gain
    return replace(told, bias=bias, score=told.score + told.information @ at, at=None)
