"""Estimates of a fit with errors of measuring chains and couplings free, as its effects of these tell them to first order."""

from collections.abc import Sequence

import numpy as np

from estimator.arrays import Floats
from estimator.fit.validation.channel_sensitivity import ChannelEffects
from estimator.machine.parameter_description import describe

OPEN_GAIN = 0.5
"""Standard deviation of each part of a gain that is free, as believed before the run [-]."""
OPEN_RUN_OUT = 1.0
"""Standard deviation of each part of a run-out that is free, in units of the channel's median amplitude [-]."""
OPEN_ROTATING = {"rotating_offset": 1e-4, "rotating_angle": 1e-3}
"""Standard deviations of each part of a coupling's run-outs of bore and face that are free [m, rad]."""


def errors_found_along(effects: ChannelEffects) -> list[int]:
    """List the errors that a fit was done with, at which its effects are linearised.

    Args:
        effects: Effects of e errors.

    Returns:
        Their places among the errors.
    """
    return np.flatnonzero(effects.errors).tolist()


def with_open_errors(
    point: Floats, covariance: Floats, effects: ChannelEffects, places: Sequence[int], *, channels: tuple[str, ...]
) -> tuple[Floats, Floats]:
    """Return estimates with some errors free, of which hardly anything is believed besides what the run says.

    Source: score and information of errors that a fit left out, Rao (1948, doi:10.1017/S0305004100023987).

    Args:
        point: Values (n,) that the effects are about [SI, logarithms of direct terms].
        covariance: Covariance (n, n) of these, the errors being what they are [SI²].
        effects: Effects of e errors.
        places: Places of the errors that are free.
        channels: Ids of the m channels.

    Returns:
        Values (n,) and covariance (n, n) [SI²]; the given ones where no error is free.
    """
    if not places:
        return point, covariance
    index, amplitude = list(places), dict(zip(channels, effects.amplitude, strict=True))
    spread = np.array([_spread(effects.names[place], amplitude) for place in index])
    shift = effects.bias[:, index] * spread  # by an error of one standard deviation
    own = effects.information[np.ix_(index, index)]
    left = np.linalg.inv(own * np.outer(spread, spread) + np.eye(len(index)))
    error = spread * (left @ (spread * (effects.score[index] + own @ effects.errors[index])))
    return point - effects.bias[:, index] @ (error - effects.errors[index]), covariance + shift @ left @ shift.T


def _spread(name: str, amplitude: dict[str, float]) -> float:
    """Return the standard deviation of an error that is free [unit of the error]."""
    said = describe(name)
    if said.quantity in OPEN_ROTATING:
        return OPEN_ROTATING[said.quantity]
    return OPEN_GAIN if said.quantity == "gain" else OPEN_RUN_OUT * amplitude[said.element_id]
