"""Choice of the samples that make a run: captured by change of speed and by time, and thinned where there are far too many.

A fit gains little from more than some hundreds of speeds and takes longer with each. Samples are picked, not averaged: a mean
over a band of speeds is no steady state at any of them where the response curves, and its error is not what the source or the
document says of a sample's. `python -m benchmarks.estimator.capture` shows both.
"""

import numpy as np
from numpy.typing import NDArray

from estimator.arrays import Floats, Indices

LARGEST_COUNT = 1000
"""Number of samples to which a longer run is thinned."""
NOISE = 8.0
"""Standard deviations of a reading below which a change of speed counts as none [-]."""


def select_samples(
    *, time: NDArray[np.int64], speed: Floats, delta_speed: float | None = None, delta_time: int | None = None
) -> Indices:
    """Pick the samples to keep: the first, and each that differs enough in speed or in time from the last one kept.

    Without delta_speed and delta_time every sample is kept.

    Args:
        time: Times (S,) [ns], ascending.
        speed: Speeds (S,) [rad/s].
        delta_speed: Change of speed that is enough [rad/s]; None to ignore the speed.
        delta_time: Change of time that is enough [ns]; None to ignore the time.

    Returns:
        Indices (k,) of the samples to keep.
    """
    if delta_speed is None and delta_time is None:
        return np.arange(time.size)
    change = np.inf if delta_speed is None else delta_speed
    wait = np.inf if delta_time is None else delta_time
    kept: list[int] = []
    last_time, last_speed = 0, 0.0
    for i, (moment, value) in enumerate(zip(time.tolist(), speed.tolist(), strict=True)):
        if not kept or abs(value - last_speed) >= change or moment - last_time >= wait:
            kept.append(i)
            last_time, last_speed = moment, value
    return np.array(kept, dtype=np.intp)


def thinned(*, time: NDArray[np.int64], speed: Floats, count: int = LARGEST_COUNT) -> Indices:
    """Pick at most `count` samples, even along the path in speed and time together.

    Half of the path is change of speed, half time: a resonance crossed fast keeps its share, and so does a long hold, in which
    noise of the readings is no change of speed.

    Args:
        time: Times (S,) [ns], ascending.
        speed: Speeds (S,) [rad/s].
        count: Most samples to keep; where there are no more, all are.

    Returns:
        Indices (k,) of the samples to keep.
    """
    if time.size <= count:
        return np.arange(time.size)
    path = _share(np.diff(_travelled(speed))) + _share(np.diff(time).astype(float))
    wanted = np.linspace(0.0, path[-1], count)
    after = np.clip(np.searchsorted(path, wanted), 1, path.size - 1)
    nearer = wanted - path[after - 1] < path[after] - wanted
    return np.unique(np.where(nearer, after - 1, after))


def _travelled(speed: Floats) -> Floats:
    """Compute the way of the speed up and down until each sample (S,), S at least 3, without the noise of the readings."""
    beside = np.abs(speed[1:-1] - (speed[:-2] + speed[2:]) / 2)
    # One in ten lies beyond 1.64 σ, and such a difference of three readings has √1.5 times the noise of one. The median would
    # be nothing where a converter's steps hide the noise most of the time.
    still = NOISE * float(np.quantile(beside, 0.9)) / (1.64 * np.sqrt(1.5))
    places, way, last = [0], [0.0], float(speed[0])
    for i, value in enumerate(speed.tolist()):
        if abs(value - last) > still or (i == speed.size - 1 and i > 0):
            places.append(i)
            way.append(way[-1] + abs(value - last))
            last = value
    return np.interp(np.arange(speed.size), places, way)


def _share(steps: Floats) -> Floats:
    """Compute the part of the sum of the steps before each sample, from 0 to 1; 0 where there are none."""
    total = float(steps.sum())
    return np.concatenate([[0.0], np.cumsum(steps) / total if total > 0 else np.zeros(steps.size)])
