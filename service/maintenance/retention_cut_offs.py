"""How far retention may go: as far as the wall clock asks for, and no further than time has passed here.

A clock that is ahead makes everything old at once. Time served, which only the monotonic clock tells, does not jump.
"""

from dataclasses import dataclass

DAY_NS = 86_400_000_000_000


@dataclass(frozen=True)
class CutOff:
    """time: what ended before that may be let go of [ns]. allowance: how far it may move beyond the time served [ns]."""

    time: int
    allowance: int = DAY_NS


def initial_cut_off(*, wanted: int, oldest: int | None, kept: int) -> CutOff:
    """Where a store begins to keep one. All times [ns].

    wanted: what clock and settings ask for. oldest: of what would be let go of at once, None where nothing would be. kept: how
    long it is to be kept. Where that would be more than a day of it, a new setting cannot be told from a wrong clock: then all
    of it counts as new.
    """
    if oldest is None or oldest >= wanted - DAY_NS:
        return CutOff(wanted)
    return CutOff(min(oldest, wanted) - kept)


def advanced_cut_off(before: CutOff, *, wanted: int, served: int) -> CutOff:
    """The cut-off moves towards what is wanted, by the time served since then and once by the allowance. All times [ns].

    Where that does not suffice it moves by the time served alone: what lies behind it waits for a person. Where it is further
    than is wanted it comes back as slowly, so that a clock that is behind for a while spoils nothing.
    """
    step = wanted - before.time
    if step > served + before.allowance:
        return CutOff(before.time + served, before.allowance)
    allowance = min(DAY_NS, before.allowance + served - max(step, 0))
    return CutOff(max(wanted, before.time - served), allowance)
