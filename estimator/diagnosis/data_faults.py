"""What is wrong with the data of some runs, not with the machine: lost channels, outliers, a model that fits no more."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from estimator.diagnosis.observation import Observation
from estimator.fit.goodness_of_fit import LARGEST_OUTLIER_PART, accepted

LOST = 0.1
"""A channel is lost when less than this part of the samples has a phasor of it …"""
PRESENT = 0.5
"""… and was there when more than this part had."""
MANY_OUTLIERS = 0.02
"""Part of the phasors left out as outliers from which on they are worth a word."""
REFUSED = 1.0
"""Least evidence of a run that no fit explains, whose χ² need not be what it was refused for."""
MOSTLY_LEFT_OUT = 0.3
"""A channel of which more than this part was left out does not count there: it is a cause by itself."""


@dataclass(frozen=True)
class DataFault:
    """Fault of the data of some runs. agreement: per run ln of the factor by which it makes the run more probable."""

    element: str
    agreement: tuple[float, ...]


def lost_channels(baseline: Sequence[Observation], window: Sequence[Observation]) -> Iterator[DataFault]:
    """Yield a fault for each channel that the baseline had and no run of the window has.

    Evidence: of the number of phasors that are missing, if each had been there as often as in the baseline.
    """
    for channel in window[-1].phasors:
        before = float(np.mean([_part(one, channel) for one in baseline]))
        if before <= PRESENT or any(_part(one, channel) >= LOST for one in window):
            continue
        missing = math.log(1.0 / (1.0 - min(before, 0.99)))
        yield DataFault(f"probe.{channel}", tuple(one.samples * missing for one in window))


def many_outliers(_baseline: Sequence[Observation], window: Sequence[Observation]) -> Iterator[DataFault]:
    """Yield a fault where outliers are spread over the channels in each run. Evidence: against half of MANY_OUTLIERS."""
    shares = [_outlying(one) for one in window]
    if all(left_out > MANY_OUTLIERS * count for left_out, count in shares):
        yield DataFault("machine", tuple(_surprise(*share) for share in shares))


def misfit(window: Sequence[Observation], faulty_channels: frozenset[str]) -> Iterator[DataFault]:
    """Yield a fault where no fit explains any of the runs, with the errors of these channels allowed for."""
    if not any(fits(one, faulty_channels) for one in window):
        yield DataFault("machine", tuple(max(REFUSED, 0.5 * (one.chi_square - one.degrees_of_freedom)) for one in window))


def fits(one: Observation, channels: frozenset[str]) -> bool:
    """Whether an identification was accepted, or would be with these channels' errors allowed for."""
    if one.accepted:
        return True
    others = {channel: count for channel, count in one.outliers.items() if channel not in channels}
    usable = sum(one.phasors.values()) + sum(one.outliers.values())
    if sum(others.values()) > LARGEST_OUTLIER_PART * usable:
        return False
    if accepted(one.chi_square, one.degrees_of_freedom):  # it was refused for what it left out, or else for no channel's fault
        return sum(one.outliers.values()) > LARGEST_OUTLIER_PART * usable
    return accepted(one.chi_square - _explained(one, channels), one.degrees_of_freedom)


def _explained(one: Observation, channels: frozenset[str]) -> float:
    """By how much χ² falls when these channels' gains and run-outs are fitted along."""
    left_out = {channel for channel, count in one.outliers.items() if count > MOSTLY_LEFT_OUT * _usable(one, channel)}
    known = np.diag(one.information) > 0.0  # of a channel without phasors nothing is
    free = known & np.array([_channel(name) in channels - left_out for name in one.names])
    machine = np.array([_channel(name) is None for name in one.names])
    if not free.any():
        return 0.0
    across = one.information[np.ix_(free, machine)]
    own = one.information[np.ix_(free, free)] - across @ np.linalg.solve(one.information[np.ix_(machine, machine)], across.T)
    score = one.gradient[free]
    return float(score @ np.linalg.solve(own, score))


def _channel(name: str) -> str | None:
    return name.split(".")[1] if name.startswith("probe.") else None


def _usable(one: Observation, channel: str) -> int:
    return one.phasors.get(channel, 0) + one.outliers.get(channel, 0)


def _part(one: Observation, channel: str) -> float:
    return _usable(one, channel) / max(1, one.samples)


def _outlying(one: Observation) -> tuple[int, int]:
    """Outliers and phasors of the channels that were not mostly left out."""
    counts = [(one.outliers.get(channel, 0), _usable(one, channel)) for channel in one.phasors]
    kept = [(left_out, usable) for left_out, usable in counts if left_out <= MOSTLY_LEFT_OUT * usable]
    return sum(left_out for left_out, _ in kept), sum(usable for _, usable in kept)


def _surprise(left_out: int, count: int) -> float:
    usual, share = MANY_OUTLIERS / 2.0, left_out / count
    return left_out * math.log(share / usual) + (count - left_out) * math.log((1.0 - share) / (1.0 - usual))
