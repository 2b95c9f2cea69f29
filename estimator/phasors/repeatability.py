"""Distance of a run's phasors from those of an earlier run of the same kind, channel by channel, in units of their noise."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats

LARGEST_STEP = 3.0
"""Largest distance of two earlier samples, over the usual step, between which is interpolated [-]."""
FEWEST_POINTS = 10
"""Least number of speeds in common."""
NOT_REPEATED = 6.0
"""Median distance in noises from which on a channel has not repeated itself [-]: run-to-run scatter of a machine stays
below."""
STANDS_OUT = 3.0
"""Ratio of a channel's distance to that of the other channels [-] above which this channel alone is named."""


@dataclass(frozen=True)
class Distance:
    """Distance of one channel from an earlier run.

    Attributes:
        noises: Median distance in units of the noise of both runs [-].
        part: Median distance as a part of the amplitude [-].
        points: Number of speeds compared.
    """

    noises: float
    part: float
    points: int


def distances(
    speed: Floats, phasor: Complexes, error: Floats, usable: NDArray[np.bool_], earlier: "EarlierRun"
) -> tuple[Distance | None, ...]:
    """Compute the distance of each of m channels from an earlier run.

    Args:
        speed: Speeds (S,) [rad/s].
        phasor: Phasors (S, m) [m].
        error: Rms of the complex errors (S, m) [m].
        usable: True where a phasor may be used (S, m).
        earlier: The earlier run.

    Returns:
        Distance of each channel; None where the runs have too few speeds in common.
    """
    found: list[Distance | None] = []
    for c in range(phasor.shape[1]):
        before, known = _interpolated(earlier, c, speed)
        both = usable[:, c] & known
        if np.count_nonzero(both) < FEWEST_POINTS:
            found.append(None)
            continue
        apart = np.abs(phasor[both, c] - before[both])
        noise = np.sqrt(2.0) * error[both, c]
        noises = np.divide(apart, noise, out=np.zeros_like(apart), where=noise > 0.0)
        part = np.divide(apart, np.abs(before[both]), out=np.zeros_like(apart), where=np.abs(before[both]) > 0.0)
        # The median size of a circular error is √(ln 2) of its rms.
        found.append(Distance(float(np.median(noises) / np.sqrt(np.log(2.0))), float(np.median(part)), int(both.sum())))
    return tuple(found)


@dataclass(frozen=True)
class EarlierRun:
    """A run to compare with.

    Attributes:
        name: Its name.
        speed: Speeds (S,) [rad/s].
        phasor: Phasors (S, m) [m].
        usable: True where a phasor may be used (S, m).
    """

    name: str
    speed: Floats
    phasor: Complexes
    usable: NDArray[np.bool_]


def repeatability_findings(channels: tuple[str, ...], found: tuple[Distance | None, ...], earlier: str) -> tuple[str, ...]:
    """Report the channels that have not repeated the phasors of an earlier run.

    Args:
        channels: Ids of the channels.
        found: Distance of each channel.
        earlier: Name of the earlier run.

    Returns:
        Findings in words.
    """
    known = [(channel, one) for channel, one in zip(channels, found, strict=True) if one is not None]
    far = [(channel, one) for channel, one in known if one.noises > NOT_REPEATED]
    if not far:
        return ()
    words = ", ".join(f"{channel} by {one.noises:.0f} times the noise ({100 * one.part:.0f} %)" for channel, one in far)
    near = [one.noises for channel, one in known if one.noises <= NOT_REPEATED]
    if len(far) < len(known) / 2 and min(one.noises for _, one in far) > STANDS_OUT * float(np.median(near)):
        return (f"repeatability: against {earlier} only {words} differs: the machine has hardly changed, look at the channel",)
    return (f"repeatability: {words} differ from {earlier}",)


def _interpolated(earlier: EarlierRun, channel: int, speed: Floats) -> tuple[Complexes, NDArray[np.bool_]]:
    """Interpolate the earlier phasors of a channel at speeds (S,), and mark where that is possible."""
    used = np.flatnonzero(earlier.usable[:, channel])
    used = used[np.argsort(earlier.speed[used], kind="stable")]
    if used.size < 2:
        return np.zeros(speed.size, dtype=complex), np.zeros(speed.size, dtype=bool)
    where = earlier.speed[used]
    step = np.diff(where)
    after = np.clip(np.searchsorted(where, speed), 1, where.size - 1)
    known = (speed >= where[0]) & (speed <= where[-1]) & (step[after - 1] <= LARGEST_STEP * np.median(step))
    return np.asarray(np.interp(speed, where, earlier.phasor[used, channel])), known
