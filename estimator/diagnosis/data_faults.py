"""Faults of the data of some runs, not of the machine: lost channels, outliers, a model that fits no more."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from estimator.alignment.film_loads import HIGHEST_PRESSURE, FilmLoad
from estimator.diagnosis.observation import Observation
from estimator.fit.validation.goodness_of_fit import LARGEST_OUTLIER_PART, accepted
from estimator.machine.parameter_description import describe

LOST = 0.1
"""Part of the samples with a phasor of a channel below which the channel is lost [-]."""
PRESENT = 0.5
"""Part of the baseline's samples with a phasor of a channel above which it was present [-]."""
MANY_OUTLIERS = 0.02
"""Part of the phasors left out as outliers from which on they are reported [-]."""
REFUSED = 1.0
"""Least evidence for a run that no fit explains: it may have been refused for another reason than its χ² [-]."""
MOSTLY_LEFT_OUT = 0.3
"""Part of a channel's phasors above which those left out do not count [-]: the channel is a cause by itself."""


LIGHT = 0.1
"""Part of its load in the baseline below which a bearing carries hardly anything [-]."""
CERTAIN = 1.645
"""Standard errors by which a load must be beyond a limit: 95 % of one side [-]."""
DOUBTFUL_PART = 0.5
"""Part of a load by which it may move over couplings that are open [-]: what would move by more is not certain either."""
ABSURD = 3.0
"""Deviations of a film, over what its document says, from which on a refused fit says nothing [-]: it ended elsewhere."""
TINY = 1e-9
"""Least error of a load [N]."""


@dataclass(frozen=True)
class DataFault:
    """Fault of the data of some runs.

    Attributes:
        element: Name of the element.
        agreement: Per run the logarithm of the factor by which the fault makes the run more probable [-].
    """

    element: str
    agreement: tuple[float, ...]


def lost_channels(baseline: Sequence[Observation], window: Sequence[Observation]) -> Iterator[DataFault]:
    """Find the channels that the baseline had and no run of the window has.

    The evidence is of the number of phasors that are missing, if each had been there as often as in the baseline.

    Args:
        baseline: Observations of the baseline.
        window: Observations of the newest runs.

    Yields:
        A fault for each lost channel.
    """
    for channel in window[-1].phasors:
        before = float(np.mean([_part(one, channel) for one in baseline]))
        if before <= PRESENT or any(_part(one, channel) >= LOST for one in window):
            continue
        missing = math.log(1.0 / (1.0 - min(before, 0.99)))
        yield DataFault(f"probe.{channel}", tuple(one.samples * missing for one in window))


def many_outliers(_baseline: Sequence[Observation], window: Sequence[Observation]) -> Iterator[DataFault]:
    """Find outliers that are spread over the channels in each run; the evidence is against half of MANY_OUTLIERS.

    Args:
        window: Observations of the newest runs.

    Yields:
        A fault where there are.
    """
    shares = [_outlying(one) for one in window]
    if all(left_out > MANY_OUTLIERS * count for left_out, count in shares):
        yield DataFault("machine", tuple(_surprise(*share) for share in shares))


def light_loads(baseline: Sequence[Observation], window: Sequence[Observation]) -> Iterator[DataFault]:
    """Find bearings on oil films that carry hardly anything of what they carried in the baseline.

    Args:
        baseline: Observations of the baseline.
        window: Observations of the newest runs.

    Yields:
        A fault at each bearing that carries less than LIGHT of it in each run, with some certainty.
    """

    def missing(before: dict[str, FilmLoad]) -> Callable[[FilmLoad], float]:
        return lambda one: LIGHT * abs(before[one.bearing].vertical) - one.vertical if one.bearing in before else -math.inf

    if _may_exceed(window, missing(_first_order_loads(baseline[-1:]))):
        yield from _certain(window, missing(_loads(baseline[-1:])))


def heavy_loads(_baseline: Sequence[Observation], window: Sequence[Observation]) -> Iterator[DataFault]:
    """Find bearings on oil films with more load on their area than white metal takes (ISO 7902-3:2020).

    Args:
        window: Observations of the newest runs.

    Yields:
        A fault at each bearing with more in each run, with some certainty.
    """

    def beyond(one: FilmLoad) -> float:
        return one.vertical - HIGHEST_PRESSURE * one.area

    if _may_exceed(window, beyond):
        yield from _certain(window, beyond)


def _may_exceed(window: Sequence[Observation], excess: Callable[[FilmLoad], float]) -> bool:
    """Return whether a load of the newest run exceeds something to first order, or lies below it by less than a part of it."""
    loads = _first_order_loads(window[-1:]).values()
    return any(excess(load) > -DOUBTFUL_PART * abs(load.vertical) for load in loads)


def _certain(window: Sequence[Observation], excess: Callable[[FilmLoad], float]) -> Iterator[DataFault]:
    """Yield the bearings whose load exceeds something in each run by more than its error allows for."""
    sizes: dict[str, list[float]] = {}
    for one in reversed(window):  # mostly the newest alone, as solving for loads takes time
        found = {bearing: excess(load) / max(load.error, TINY) for bearing, load in _loads([one]).items()}
        sizes = {
            bearing: [size, *sizes.get(bearing, [])]
            for bearing, size in found.items()
            if size > CERTAIN and (bearing in sizes or one is window[-1])
        }
        if not sizes:
            return
    for bearing, own in sizes.items():
        yield DataFault(f"bearing.{bearing}", tuple(0.5 * size**2 for size in own))


def _loads(runs: Sequence[Observation]) -> dict[str, FilmLoad]:
    return {load.bearing: load for one in runs if one.loads is not None for load in one.loads.known()}


def _first_order_loads(runs: Sequence[Observation]) -> dict[str, FilmLoad]:
    return {load.bearing: load for one in runs if one.loads is not None for load in one.loads.first_order()}


def misfit(window: Sequence[Observation], faulty_channels: frozenset[str]) -> Iterator[DataFault]:
    """Find out whether no fit explains any of the runs, with the errors of some channels allowed for.

    Args:
        window: Observations of the newest runs.
        faulty_channels: Ids of the channels, and names of the couplings, whose errors are allowed for.

    Yields:
        A fault where none does.
    """
    if not any(fits(one, faulty_channels) for one in window):
        yield DataFault("machine", tuple(max(REFUSED, 0.5 * (one.chi_square - one.degrees_of_freedom)) for one in window))


def fits(one: Observation, channels: frozenset[str]) -> bool:
    """Check whether an identification was accepted, or would be with the errors of some channels or couplings allowed for.

    A train's films may explain a refused run with large deviations, which are a cause by themselves unless they are absurd.

    Source: fall of χ² by score test of Rao, Math. Proc. Camb. Phil. Soc. 44 (1948) 50, doi:10.1017/S0305004100023987.

    Args:
        one: Observation of the run.
        channels: Ids of the channels, and names of the couplings.

    Returns:
        Whether it was or would be.
    """
    by_films = one.believed is not None and not is_uninformative(one) and not _explained_by_errors(one)
    deviating = by_films and accepted(one.chi_square, one.degrees_of_freedom)
    return is_trusted(one, channels) or (deviating and not _leaves_out_others(one, channels))


def is_trusted(one: Observation, channels: frozenset[str]) -> bool:
    """Check whether what a fit has found holds: it was accepted, or is but for errors of some channels or couplings.

    Source: fall of χ² by score test of Rao, Math. Proc. Camb. Phil. Soc. 44 (1948) 50, doi:10.1017/S0305004100023987.

    Args:
        one: Observation of the run.
        channels: Ids of the channels, and names of the couplings.

    Returns:
        Whether it does.
    """
    if one.accepted or _leaves_out_others(one, channels):
        return one.accepted
    if accepted(one.chi_square, one.degrees_of_freedom) and not _explained_by_errors(one):
        # It was refused for what it left out, or else for no channel's fault.
        return sum(one.outliers.values()) > LARGEST_OUTLIER_PART * _usable_phasors(one)
    return accepted(one.chi_square - _explained(one, channels), one.degrees_of_freedom)


def _explained_by_errors(one: Observation) -> bool:
    """Check whether a refused fit was accepted with errors of channels or couplings, from where its run is told."""
    return bool(np.any(one.reference[one.coordinates :] != 0.0))


def _leaves_out_others(one: Observation, channels: frozenset[str]) -> bool:
    """Check whether a fit has left out too many phasors of other channels than some."""
    others = sum(count for channel, count in one.outliers.items() if channel not in channels)
    return others > LARGEST_OUTLIER_PART * _usable_phasors(one)


def _usable_phasors(one: Observation) -> int:
    return sum(one.phasors.values()) + sum(one.outliers.values())


def is_uninformative(one: Observation) -> bool:
    """Check whether a refused fit of a train on oil films ended where films deviate absurdly: elsewhere than the machine is.

    Args:
        one: Observation of the run.

    Returns:
        Whether it did.
    """
    return not one.accepted and one.believed is not None and _largest_deviation(one) >= ABSURD


def _largest_deviation(one: Observation) -> float:
    """Compute the root mean square of the deviations of the film that deviates most, over what its document says."""
    films: dict[str, list[float]] = {}
    for name, value in zip(one.names, one.reference, strict=True):
        if describe(name).element_kind == "films":
            films.setdefault(describe(name).element, []).append(float(value) ** 2)
    return math.sqrt(max((math.fsum(own) / len(own) for own in films.values()), default=0.0))


def _explained(one: Observation, channels: frozenset[str]) -> float:
    """Compute the fall of χ² when the errors of these channels and couplings are fitted along."""
    left_out = {channel for channel, count in one.outliers.items() if count > MOSTLY_LEFT_OUT * _usable(one, channel)}
    information = one.fitted
    known = np.diag(information) > 0.0  # of a channel without phasors nothing is
    free = known & np.array([describe(name).error_of in channels - left_out for name in one.names])
    machine = np.array([describe(name).error_of is None for name in one.names])
    beside_fit = np.arange(len(one.names)) >= one.coordinates
    if not free.any():
        return 0.0
    across = information[free][:, machine] @ np.linalg.inv(information[np.ix_(machine, machine)])
    beside = information[free] - across @ information[machine]
    own = beside[:, free]
    score = one.gradient[free] + beside[:, beside_fit] @ one.reference[beside_fit]  # with all errors that fits leave out zero
    return float(score @ np.linalg.solve(own, score))


def _usable(one: Observation, channel: str) -> int:
    return one.phasors.get(channel, 0) + one.outliers.get(channel, 0)


def _part(one: Observation, channel: str) -> float:
    return _usable(one, channel) / max(1, one.samples)


def _outlying(one: Observation) -> tuple[int, int]:
    """Count outliers and phasors of the channels that were not mostly left out."""
    counts = [(one.outliers.get(channel, 0), _usable(one, channel)) for channel in one.phasors]
    kept = [(left_out, usable) for left_out, usable in counts if left_out <= MOSTLY_LEFT_OUT * usable]
    return sum(left_out for left_out, _ in kept), sum(usable for _, usable in kept)


def _surprise(left_out: int, count: int) -> float:
    usual, share = MANY_OUTLIERS / 2.0, left_out / count
    return left_out * math.log(share / usual) + (count - left_out) * math.log((1.0 - share) / (1.0 - usual))
