"""Estimates of a fit with errors of measuring chains and couplings free, as its effects of these tell them to first order."""

from collections.abc import Sequence

import numpy as np
from msgspec.structs import replace

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
    index = list(places)
    if not index:
        return point, covariance
    error, spread = _open_errors(effects, index, channels)
    shift = effects.bias[:, index]
    return point - shift @ (error - effects.errors[index]), covariance + shift @ spread @ shift.T


def about_open_errors(
    point: Floats, covariance: Floats, effects: ChannelEffects, places: Sequence[int], *, channels: tuple[str, ...]
) -> ChannelEffects:
    """Return the effects of errors about the values that some errors have which are free; to first order nothing else changes.

    Source: score and information of errors that a fit left out, Rao (1948, doi:10.1017/S0305004100023987).

    Args:
        point: Values (n,) that the effects are about [SI, logarithms of direct terms].
        covariance: Covariance (n, n) of these, the errors being what they are [SI²].
        effects: Effects of e errors.
        places: Places of the errors that are free.
        channels: Ids of the m channels.

    Returns:
        The effects.
    """
    index, at = list(places), effects.errors.copy()
    at[index] = _open_errors(effects, index, channels)[0]
    moved = at - effects.errors
    return replace(
        effects,
        at=at,
        score=effects.score - effects.information @ moved,
        point=point - effects.bias @ moved,
        covariance=covariance,
    )


def beside_its_errors(
    coordinates: tuple[str, ...],
    point: Floats,
    covariance: Floats,
    effects: ChannelEffects | None,
    *,
    channels: tuple[str, ...],
) -> tuple[tuple[str, ...], Floats, Floats]:
    """Return the estimates of a fit together with the errors of channels that they were found along, for predictions.

    Source: score and information of errors that a fit left out, Rao (1948, doi:10.1017/S0305004100023987).

    Args:
        coordinates: Names of the n coordinates of a fit.
        point: Values (n,) that it tells [SI, logarithms of direct terms].
        covariance: Covariance (n, n) of these [SI²].
        effects: Effects of errors about them; None where an older release states none.
        channels: Ids of the m channels.

    Returns:
        Names, values (n + e,) and covariance (n + e, n + e) of the coordinates and of the e errors behind them [SI or 1]; the
        given ones without any.
    """
    found_along = [] if effects is None else errors_found_along(effects)
    index = (
        [] if effects is None else [place for place in found_along if describe(effects.names[place]).element_kind == "probe"]
    )
    if effects is None or not index:
        return coordinates, point, covariance
    error, spread = _open_errors(effects, index, channels)
    across = -effects.bias[:, index] @ spread
    whole = np.block([[covariance, across], [across.T, spread]])
    return (*coordinates, *(effects.names[place] for place in index)), np.concatenate([point, error]), whole


def _open_errors(effects: ChannelEffects, index: list[int], channels: tuple[str, ...]) -> tuple[Floats, Floats]:
    """Return errors (k,) that are free, and their covariance (k, k) [unit]."""
    amplitude = dict(zip(channels, effects.amplitude, strict=True))
    spread = np.array([_spread(effects.names[place], amplitude) for place in index])
    own = effects.information[np.ix_(index, index)]
    left = np.linalg.inv(own * np.outer(spread, spread) + np.eye(len(index)))
    error = spread * (left @ (spread * (effects.score[index] + own @ effects.errors[index])))
    return error, np.asarray(left * np.outer(spread, spread))


def _spread(name: str, amplitude: dict[str, float]) -> float:
    """Return the standard deviation of an error that is free [unit of the error]."""
    said = describe(name)
    if said.quantity in OPEN_ROTATING:
        return OPEN_ROTATING[said.quantity]
    return OPEN_GAIN if said.quantity == "gain" else OPEN_RUN_OUT * amplitude[said.element_id]
