"""Gains that are clearly off, as the score of a fit tells them, and the fit done again with some of them."""

import math
from collections.abc import Mapping

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from estimator.arrays import Floats
from estimator.fit.optimisation.maximum_likelihood import fit
from estimator.fit.optimisation.reweighting import with_fitted_noise
from estimator.fit.problem.channel_errors import UNIT_SPREAD, with_channel_errors
from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.fit.validation.channel_sensitivity import MOSTLY_LEFT_OUT, ChannelEffects
from estimator.machine.parameter_description import COMPONENTS

CLEAR_FALL = 20.0
"""Fall of χ² with a gain from which on it is clearly off [-]: chance brings it once in 20,000 channels."""
LARGE_GAIN = 0.03
"""Part of itself by which a gain must be off for the second order to count [-]."""


class GainError(Struct, frozen=True, eq=False):
    """Error of one channel's gain, to first order.

    Attributes:
        channel: Place of the channel.
        places: Places of both parts among the errors (2,).
        fall: Fall of χ² with it [-].
        size: Its magnitude [-].
    """

    channel: int
    places: list[int]
    fall: float
    size: float


class FitWithGains(Struct, frozen=True, eq=False):
    """A fit that was done again with the gains of some channels, from its end.

    Attributes:
        channels: Places of these channels.
        problem: Its problem, with these gains behind the fit's own coordinates.
        found: The fit.
        gains: What the gains differ by from those of the document, by the name of each part [-].
    """

    channels: tuple[int, ...]
    problem: FitProblem
    found: FitResult
    gains: Mapping[str, float]

    @property
    def cost(self) -> float:
        """Return what it leaves over, with what the prior adds [-]."""
        return cost(self.problem, self.found)

    def without(self, size: int) -> FitResult:
        """Return the fit with its own coordinates only.

        Args:
            size: Their number.

        Returns:
            The fit.
        """
        return replace(self.found, theta=self.found.theta[:size])


def cost(problem: FitProblem, found: FitResult) -> float:
    """Return minus twice the logarithm of the posterior at a fit's end, less a constant of its data.

    With a stated noise that is χ² and the prior's cost. Where the noise is estimated the fit's misfit is its variance, of n
    numbers, and the likelihood's part n times the logarithm of that: a gain is judged by the ratio of variances.

    Source: the likelihood of normal errors of unknown variance (Seber and Wild, Nonlinear Regression, 2003, sec. 2.2.1).

    Args:
        problem: The fit's problem.
        found: The fit.

    Returns:
        The cost [-].
    """
    prior = problem.coordinates.prior.cost(found.theta)
    if not problem.noise.estimated:
        return found.misfit + prior
    numbers = 2 * np.count_nonzero(problem.measurement.usable)  # also those left out: the misfit counts them
    return numbers * math.log(max(found.misfit, float(np.finfo(float).tiny))) + prior


def clear_gains(
    problem: FitProblem, found: FitResult, effects: ChannelEffects, *, least: float, beside: tuple[int, ...] = ()
) -> list[GainError]:
    """Find the gains with which χ² would fall by much (score test); none of a calibrated fit.

    None is asked where the fit has given up a channel: that one is at fault, and what it leaves over another's only in part.

    Source: Rao (Proc. Camb. Phil. Soc. 44 (1948) 50, doi:10.1017/S0305004100023987).

    Args:
        problem: The fit's problem.
        found: The fit.
        effects: Effects of the errors that it left out.
        least: Fall of χ² from which on a gain is clearly off [-].
        beside: Places of the channels whose gains are free already.

    Returns:
        The gains, that with the largest fall first.
    """
    usable = np.count_nonzero(problem.measurement.usable, axis=0)
    left_out = np.count_nonzero(found.outlier & problem.measurement.usable, axis=0)
    if problem.coordinates.calibrated is not None or np.any(left_out > MOSTLY_LEFT_OUT * usable):
        return []
    channels = problem.train.channels
    free = [place for one in beside for place in _places(effects, channels[one])]
    errors = []
    for channel, name in enumerate(channels):
        places = _places(effects, name)
        if channel in beside or not places or not usable[channel]:
            continue
        every = [*places, *free]
        gain = np.linalg.lstsq(effects.information[np.ix_(every, every)], effects.score[every])[0]
        errors.append(GainError(channel, places, float(gain @ effects.score[every]), float(np.hypot(*gain[:2]))))
    if not errors:
        return []
    ordered = sorted(errors, key=lambda one: -one.fall)
    return [one for one in ordered if one.fall >= least and one.size >= LARGE_GAIN] if ordered[0].size >= LARGE_GAIN else []


def fit_with_gains(
    problem: FitProblem, found: FitResult, channels: tuple[int, ...], *, start: Floats | None = None
) -> FitWithGains | None:
    """Return a fit done again with the gains of some channels, from its end.

    Source: Marquardt (1963, doi:10.1137/0111030), at the noise that the fit has found.

    Args:
        problem: The fit's problem.
        found: The fit.
        channels: Places of the channels.
        start: Fit coordinates (k,) to start from, of the fit and of the first gains [-]; None for the fit's end.

    Returns:
        The fit; None where it did not converge.
    """
    own, names = problem.coordinates, [problem.train.channels[one] for one in channels]
    behind = with_channel_errors(own, problem.train.channels, [("gain", one) for one in channels], spread=UNIT_SPREAD)
    free = with_fitted_noise(problem.with_channels(behind, found.theta), found)
    begun = found.theta if start is None else start
    again = fit(free, np.concatenate([begun, np.zeros(behind.size - begun.size)]), near=True)
    if not again.converged:
        return None
    parts = [part for name in names for part in _names(name)]
    gains = dict(zip(parts, again.theta[own.size :].tolist(), strict=True))
    return FitWithGains(channels, replace(free, outlier=again.outlier), again, gains)


def _names(channel: str) -> list[str]:
    return [f"probe.{channel}.gain.{part}" for part in COMPONENTS]


def _places(effects: ChannelEffects, channel: str) -> list[int]:
    """Return the places of both parts of a channel's gain; none where the fit has identified it."""
    return [effects.names.index(one) for one in _names(channel) if one in effects.names]
