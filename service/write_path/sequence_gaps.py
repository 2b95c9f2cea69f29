"""Sequence gaps: missing numbers of a source, which may still arrive out of order or be recalled from its log."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

LARGEST_COUNT = 1_000
"""Gaps recorded per source; older ones are lost for good."""
NEVER = 2**62
"""Upper limit of the times in a gap whose following sample is unknown."""


class SequenceGap(NamedTuple):
    """Missing numbers first to last, and the times of the samples around them, between which their times must lie [ns]."""

    first: int
    last: int
    after: int
    before: int


@dataclass(frozen=True)
class FilledPart:
    """Samples `start` to before `stop` of a batch that fall into one gap."""

    gap: SequenceGap
    start: int
    stop: int

    @property
    def count(self) -> int:
        """Return the number of samples."""
        return self.stop - self.start


def stored_gaps(stored: Iterable[Sequence[int]] | None) -> list[SequenceGap]:
    """Return the gaps stored with a source, ascending."""
    return [SequenceGap(*one) for one in stored or ()]


def as_stored(gaps: Iterable[SequenceGap]) -> list[list[int]] | None:
    """Return gaps in the form in which they are stored with a source."""
    return [list(gap) for gap in gaps] or None


def filled_parts(gaps: Sequence[SequenceGap], *, first: int, count: int) -> list[FilledPart]:
    """Return the parts of a batch of `count` samples numbered from `first` that fill gaps, ascending."""
    found = []
    for gap in gaps:
        start, stop = max(gap.first, first) - first, min(gap.last, first + count - 1) - first + 1
        if start < stop:
            found.append(FilledPart(gap, start, stop))
    return found


def fill(gaps: Sequence[SequenceGap], part: FilledPart, *, first: int, times: NDArray[np.int64]) -> list[SequenceGap]:
    """Return the gaps left after a part of the batch numbered from `first` arrived. times: times of its accepted samples
    [ns]."""
    gap = part.gap
    left = gap._replace(last=first + part.start - 1, before=int(times[0]) if times.size else gap.before)
    right = gap._replace(first=first + part.stop, after=int(times[-1]) if times.size else gap.after)
    rest = [one for one in (left, right) if one.first <= one.last]
    return [new for one in gaps for new in (rest if one == gap else [one])]


def add_gap(gaps: Sequence[SequenceGap], gap: SequenceGap) -> list[SequenceGap]:
    """Return the gaps with another one behind all others."""
    return [*gaps, gap][-LARGEST_COUNT:]
