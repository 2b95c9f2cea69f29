"""Downsamples series for plots without losing their extremes."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

NONE = "none"
MIN_MAX = "min-max-per-bucket"


@dataclass(frozen=True)
class Chosen:
    """Points that stay after downsampling. index: index of these points, ascending; points: their number before."""

    index: NDArray[np.int64]
    method: str
    points: int


def min_max(time: NDArray[np.int64], value: NDArray[np.float64], kind: NDArray[np.int64], *, most: int) -> Chosen:
    """Choose at most `most` of n points in order of time: the first, the last, and each kind's extremes per bucket of time.

    Where a kind has points in a bucket but no value (NaN), the first of them stays: a gap remains visible. kind: a number for
    each point. Kinds are chosen separately unless `most` (at least 4) leaves no room for two points of each. Nothing is
    averaged: every point that stays is one of the original points.
    """
    count = len(time)
    if count <= most:
        return Chosen(np.arange(count), NONE, count)
    if most < 2 + 2 * len(np.unique(kind)):
        kind = np.zeros_like(kind)
    kinds = np.unique(kind)
    buckets = (most - 2) // (2 * len(kinds))
    span = max(1, int(time[-1]) - int(time[0]))
    # In floating point: nanoseconds times buckets overflow an integer.
    place = np.minimum(((time - time[0]) / span * buckets).astype(np.int64), buckets - 1)
    kept = [np.array([0, count - 1])]
    for one in kinds:
        of_kind = np.flatnonzero(kind == one)
        kept.append(of_kind[_extremes(place[of_kind], value[of_kind])])
    return Chosen(np.unique(np.concatenate(kept)), MIN_MAX, count)


def _extremes(place: NDArray[np.int64], value: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the lowest and the highest value at each place, or its first point where it has no value."""
    known = np.isfinite(value)
    first = np.unique(place, return_index=True)[1]
    kept = [first[~np.isin(place[first], place[known])]]
    for sign in (1.0, -1.0):
        order = np.lexsort((sign * value[known], place[known]))
        lowest = np.unique(place[known][order], return_index=True)[1]
        kept.append(np.flatnonzero(known)[order[lowest]])
    return np.concatenate(kept)
