"""Fewer points of a series for drawing it, without losing its extremes."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

NONE = "none"
MIN_MAX = "min-max-per-bucket"


@dataclass(frozen=True)
class Chosen:
    """index: the points that stay, ascending. method: how they were chosen. points: how many there were."""

    index: NDArray[np.int64]
    method: str
    points: int


def min_max(time: NDArray[np.int64], value: NDArray[np.float64], *, most: int) -> Chosen:
    """At most `most` (4 or more) of n points that are in order of time: the first, the last, and of each of equal stretches of
    time the lowest and the highest. Of a stretch without any value (NaN) its first point stays: a gap is seen as one.

    Every point that stays is one that was there; nothing is averaged.
    """
    count = len(time)
    if count <= most:
        return Chosen(np.arange(count), NONE, count)
    buckets = (most - 2) // 2
    span = max(1, int(time[-1]) - int(time[0]))
    # In floating point: nanoseconds times buckets would not fit.
    place = np.minimum(((time - time[0]) / span * buckets).astype(np.int64), buckets - 1)
    known = np.isfinite(value)
    kept = [np.array([0, count - 1]), np.unique(place, return_index=True)[1]]
    kept[1] = kept[1][~np.isin(place[kept[1]], place[known])]
    for sign in (1.0, -1.0):
        order = np.lexsort((sign * value[known], place[known]))
        first = np.unique(place[known][order], return_index=True)[1]
        kept.append(np.flatnonzero(known)[order[first]])
    return Chosen(np.unique(np.concatenate(kept)), MIN_MAX, count)
