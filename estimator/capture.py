"""Which samples of a stretch make a run: captured by change of speed and by time, and thinned where there are far too many.

A fit gains little from more than some hundreds of speeds and takes longer with each. Samples are picked, not averaged: a mean
over a band of speeds is no steady state at any of them where the response curves, and its error is not what the source or the
document says of a sample's. `python -m benchmarks.capture` shows both.
"""

import numpy as np
from numpy.typing import NDArray

from estimator.condensation import Floats

Indices = NDArray[np.intp]

LARGEST_COUNT = 1000
"""A run of more samples is thinned to about so many."""


def captured(
    *, time: NDArray[np.int64], speed: Floats, delta_speed: float | None = None, delta_time: int | None = None
) -> Indices:
    """Indices of the samples to keep: the first, and each that differs enough from the last one kept.

    time: (S,) [ns], ascending. speed: (S,) [rad/s]. delta_speed [rad/s], delta_time [ns]: enough is either of them; without
    both every sample is kept.
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
    """Indices of about `count` samples, or all where there are fewer: half of them even in speed, half even in time.

    time: (S,) [ns], ascending. speed: (S,) [rad/s]. A long hold keeps its share by time; a resonance crossed quickly keeps its
    share by speed.
    """
    if time.size <= count:
        return np.arange(time.size)
    return np.unique(np.concatenate([_even(speed, count // 2), _even(time.astype(float), count - count // 2)]))


def _even(values: Floats, count: int) -> Indices:
    """Indices of the values nearest to `count` even steps from the least to the greatest."""
    order = np.argsort(values, kind="stable")
    ascending = values[order]
    wanted = np.linspace(ascending[0], ascending[-1], count)
    after = np.clip(np.searchsorted(ascending, wanted), 1, values.size - 1)
    nearer = wanted - ascending[after - 1] < ascending[after] - wanted
    return np.asarray(order[np.where(nearer, after - 1, after)])
