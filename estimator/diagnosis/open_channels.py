"""Fits beside errors of measuring chains that a diagnosis has named: the same estimates with these errors free.

A fit takes a probe's gain as the document has it. Where that has drifted, the fit's estimates are off, and its covariance
knows nothing of that. To first order the fit says how an error would move it, and what the run knows of the error.
"""

from collections.abc import Iterable

import numpy as np

from estimator.arrays import Floats
from estimator.diagnosis.finding_kinds import FINDING_KINDS
from estimator.fit.validation.channel_sensitivity import ChannelEffects
from estimator.machine.parameter_description import describe

OPEN_GAIN = 0.5
"""Standard deviation of each part of a gain that is free, as believed before the run [-]."""
OPEN_RUN_OUT = 1.0
"""Standard deviation of each part of a run-out that is free, in units of the channel's median amplitude [-]."""
OPEN_ROTATING = {"rotating_offset": 1e-4, "rotating_angle": 1e-3}
"""Standard deviations of each part of a coupling's run-outs of bore and face that are free [m, rad]."""
_ERRORS = {one.kind: one.errors for one in FINDING_KINDS if one.errors}


def estimate_beside(
    point: Floats,
    covariance: Floats,
    effects: ChannelEffects | None,
    named: Iterable[tuple[str, str]],
    *,
    channels: tuple[str, ...],
) -> tuple[Floats, Floats]:
    """Return a fit's estimate with the errors of chains free that causes stand for (score and information: Rao 1948).

    So are errors that the effects are linearised at: those along which alone the fit was accepted, or a gain that is clearly
    off. What the run itself says of an error is in its effects; else hardly anything is believed of it.

    Source: score and information of errors that a fit left out, Rao (1948, doi:10.1017/S0305004100023987).

    Args:
        point: Values (n,) of the fit [SI, logarithms of direct terms].
        covariance: Covariance (n, n) of these [SI²].
        effects: Effects of channels' errors on it; None where an older release states none.
        named: Kind and element of each cause that a diagnosis has named.
        channels: Ids of the m channels.

    Returns:
        Values (n,) and covariance (n, n) [SI²]; the given ones where no error is free.
    """
    wrong = {f"{element}.{quantity}" for kind, element in named for quantity in _ERRORS.get(kind, ())}
    if effects is None:
        return point, covariance
    amplitude = dict(zip(channels, effects.amplitude, strict=True))
    point, covariance = effects.estimate(point, covariance)
    found_at = np.zeros(len(effects.names)) if effects.at is None else effects.at
    places = [place for place, name in enumerate(effects.names) if describe(name).whole in wrong or found_at[place] != 0.0]
    if not places:
        return point, covariance
    spread = np.array([_spread(effects.names[place], amplitude) for place in places])
    shift = effects.bias[:, places] * spread  # by an error of one standard deviation
    own = effects.information[np.ix_(places, places)]
    left = np.linalg.inv(own * np.outer(spread, spread) + np.eye(len(places)))
    error = spread * (left @ (spread * (effects.score[places] + own @ found_at[places])))
    return point - effects.bias[:, places] @ (error - found_at[places]), covariance + shift @ left @ shift.T


def _spread(name: str, amplitude: dict[str, float]) -> float:
    """Return the standard deviation of an error that is free [unit of the error]."""
    said = describe(name)
    if said.quantity in OPEN_ROTATING:
        return OPEN_ROTATING[said.quantity]
    return OPEN_GAIN if said.quantity == "gain" else OPEN_RUN_OUT * amplitude[said.element_id]
