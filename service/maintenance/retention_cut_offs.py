"""Cut-offs of retention: as far as the wall clock asks for, but no further than the service time allows.

A clock that is ahead makes everything old at once. Service time, which is measured by the monotonic clock, does not jump.
"""

from dataclasses import dataclass

DAY_NS = 86_400_000_000_000


@dataclass(frozen=True)
class CutOff:
    """A cut-off of retention. time: what ended before it may be deleted [ns]. allowance: how far it may exceed the service
    time [ns]."""

    time: int
    allowance: int = DAY_NS


def initial_cut_off(*, wanted: int, oldest: int | None, kept: int) -> CutOff:
    """Return the first cut-off of a store. All times [ns].

    wanted: what clock and settings ask for. oldest: time of the oldest data to be deleted at once, None without any. kept: how
    long data are kept. When more than a day's data would be deleted, a new setting cannot be told from a wrong clock: then all
    data count as new.
    """
    if oldest is None or oldest >= wanted - DAY_NS:
        return CutOff(wanted)
    return CutOff(min(oldest, wanted) - kept)


def advanced_cut_off(before: CutOff, *, wanted: int, served: int) -> CutOff:
    """Return the cut-off moved towards what is wanted, by the service time since then and once by the allowance. All times
    [ns].

    When that does not suffice it moves by the service time alone: data behind it wait for a person. When it is further than
    wanted by a day or less it moves back as slowly. Beyond that it moves back at once: the clock was ahead, and what it made
    old is new. A clock that is behind cannot be told from that; once it is right, data wait for a person as well.
    """
    step = wanted - before.time
    if step < -DAY_NS:
        return CutOff(wanted, before.allowance)
    if step > served + before.allowance:
        return CutOff(before.time + served, before.allowance)
    allowance = min(DAY_NS, before.allowance + served - max(step, 0))
    return CutOff(max(wanted, before.time - served), allowance)
