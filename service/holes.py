"""Numbers of a source that never came, while they may still come: out of order, or asked for again.

A hole is [first, last, after, before]: the numbers, and the times between which their samples must lie [ns], those of the
samples around them. Plain lists: they are stored with the source.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Hole = list[int]

LARGEST_COUNT = 1_000
"""Holes remembered of one source; older ones stay lost for good."""
NEVER = 2**62
"""Time before which samples must lie where the sample behind them is not known."""


@dataclass(frozen=True)
class Piece:
    """Samples start to before stop of a batch that fall into one hole."""

    hole: Hole
    start: int
    stop: int


def pieces(holes: Sequence[Hole], *, first: int, count: int) -> list[Piece]:
    """What of a batch of `count` samples numbered from `first` fills holes, in ascending order."""
    found = []
    for hole in holes:
        start, stop = max(hole[0], first) - first, min(hole[1], first + count - 1) - first + 1
        if start < stop:
            found.append(Piece(hole, start, stop))
    return found


def filled(holes: Sequence[Hole], piece: Piece, *, first: int, times: NDArray[np.int64]) -> list[Hole]:
    """The holes left after a piece of the batch numbered from `first` came; times: of its samples that were taken [ns]."""
    low, high, after, before = piece.hole
    left = [low, first + piece.start - 1, after, int(times[0]) if times.size else before]
    right = [first + piece.stop, high, int(times[-1]) if times.size else after, before]
    rest = [one for one in (left, right) if one[0] <= one[1]]
    return [new for hole in holes for new in (rest if hole is piece.hole else [hole])]


def noted(holes: Sequence[Hole], hole: Hole) -> list[Hole]:
    """The holes with one more, which lies behind all others."""
    return [*holes, hole][-LARGEST_COUNT:]
