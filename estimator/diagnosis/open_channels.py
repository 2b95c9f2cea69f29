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

    What the run itself says of such an error is in its effects; else hardly anything is believed of it.

    Source: score and information of errors that a fit left out, Rao (1948, doi:10.1017/S0305004100023987).

    Args:
        point: Values (n,) of the fit [SI, logarithms of direct terms].
        covariance: Covariance (n, n) of these [SI²].
        effects: Effects of channels' errors on it; None where an older release states none.
        named: Kind and element of each cause that a diagnosis has named.
        channels: Ids of the m channels.

    Returns:
        Values (n,) and covariance (n, n) [SI²]; the given ones where no cause is one of a measuring chain.
    """
    wrong = {f"{element}.{quantity}" for kind, element in named for quantity in _ERRORS.get(kind, ())}
    if effects is None:
        return point, covariance
    amplitude = dict(zip(channels, effects.amplitude, strict=True))
    places = [place for place, name in enumerate(effects.names) if describe(name).whole in wrong]
    if not places:
        return point, covariance
    spread = np.array([_spread(effects.names[place], amplitude) for place in places])
    shift = effects.bias[:, places] * spread  # by an error of one standard deviation
    at = np.zeros(len(places)) if effects.at is None else effects.at[places] / spread
    own = effects.information[np.ix_(places, places)] * np.outer(spread, spread)
    left = np.linalg.inv(own + np.eye(len(places)))
    error = left @ (effects.score[places] * spread + own @ at)
    return point - shift @ (error - at), covariance + shift @ left @ shift.T


def _spread(name: str, amplitude: dict[str, float]) -> float:
    """Return the standard deviation of an error that is free [unit of the error]."""
    said = describe(name)
    return OPEN_GAIN if said.quantity == "gain" else OPEN_RUN_OUT * amplitude[said.element_id]
