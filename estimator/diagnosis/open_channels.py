"""Fits beside errors of measuring chains that a diagnosis has named: the same estimates with these errors free.

A fit takes a probe's gain as the document has it. Where that has drifted, the fit's estimates are off, and its covariance
knows nothing of that. To first order the fit says how an error would move it, and what the run knows of the error.
"""

from collections.abc import Iterable

from estimator.arrays import Floats
from estimator.diagnosis.finding_kinds import FINDING_KINDS
from estimator.fit.omitted_errors.open_errors import errors_found_along, with_open_errors
from estimator.fit.validation.channel_sensitivity import ChannelEffects
from estimator.machine.parameter_description import describe

_ERRORS = {one.kind: one.errors for one in FINDING_KINDS if one.errors}


def named_errors(named: Iterable[tuple[str, str]]) -> frozenset[str]:
    """List the errors of measuring chains and couplings that causes stand for, such as `probe.B1L.gain`.

    Args:
        named: Kind and element of each cause that a diagnosis has named.

    Returns:
        Names of the errors.
    """
    return frozenset(f"{element}.{quantity}" for kind, element in named for quantity in _ERRORS.get(kind, ()))


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
    wrong = named_errors(named)
    if effects is None:
        return point, covariance
    found_along = set(errors_found_along(effects))
    places = [place for place, name in enumerate(effects.names) if describe(name).whole in wrong or place in found_along]
    return with_open_errors(*effects.estimate(point, covariance), effects, places, channels=channels)
