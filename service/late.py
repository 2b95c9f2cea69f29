"""Samples that come after run collection has passed their time: sorted into the runs that they belong to.

The stretch of time in which they came is gone through again, from the store and with the same state machine. A sweep found
there that was collected before is reopened: made anew with all its samples and identified again. One that nobody knew of,
such as a whole run-down after an hour without a network, becomes a run of its own. Each time a run was reopened it waits
twice as long for more: samples that trickle in over a day cost a dozen identifications, not one each.
"""

import logging
from collections.abc import Sequence

import numpy as np
from sqlalchemy.orm import Session

from estimator.machine import Machine
from estimator.operating_state import OperatingLimits, OperatingState, advance, silence
from estimator.segmentation import RunEnded, RunKind
from estimator.speed_bins import ROLLING
from service.closing import LARGEST_READ, close_sweep, tell_damaged
from storage import machines, runs, samples
from storage.clock import now
from storage.tables import RunRow

logger = logging.getLogger(__name__)

Window = list[int]
"""Revision of the document, first and last time of samples that came late [ns], how many."""

BESIDE = 120_000_000_000
"""Late samples this near to each other [ns] are looked at together, and with what was known so near to them."""
LARGEST_COUNT = 100
"""Windows remembered of one machine; beyond this the two oldest are looked at as one."""


def noted(windows: list[Window], revision: int, times: list[int]) -> list[Window]:
    """The windows with more late samples, ascending."""
    merged: list[Window] = []
    for window in sorted([*windows, *([revision, time, time, 1] for time in times)]):
        if merged and merged[-1][0] == window[0] and window[1] - merged[-1][2] <= BESIDE:
            merged[-1] = _joined(merged[-1], window)
        else:
            merged.append(window)
    while len(merged) > LARGEST_COUNT:
        merged[:2] = [_joined(*merged[:2])] if merged[0][0] == merged[1][0] else [merged[1]]
    return merged


def _joined(one: Window, other: Window) -> Window:
    return [one[0], one[1], max(one[2], other[2]), one[3] + other[3]]


def settle(session: Session, machine_id: str, windows: list[Window], *, patience_s: float) -> list[Window]:
    """Sort in the samples of windows, ascending; which of them must wait.

    They wait for a run beside them that is still open, and for one that was reopened not long ago: the first time for
    `patience_s`, then for twice as long each time.
    """
    together = _by_run(session, machine_id, windows)
    return [window for window in together if not _settled(session, machine_id, window, patience_s)]


def _by_run(session: Session, machine_id: str, windows: list[Window]) -> list[Window]:
    """Those that lie in one run as one, so that it is made anew once."""
    merged: list[Window] = []
    inside: set[int] = set()
    for window in windows:
        revision, first, last, _ = window
        here = {row.id for row in runs.touching(session, machine_id, revision=revision, first=first, last=last)}
        if merged and merged[-1][0] == revision and here & inside:
            merged[-1] = _joined(merged[-1], window)
            inside |= here
        else:
            merged.append(window)
            inside = here
    return merged


def _settled(session: Session, machine_id: str, window: Window, patience_s: float) -> bool:
    """Sort in one window; False when that must wait."""
    revision, first, last, count = window
    machine = machines.document(session, machine_id, revision)
    if machine.collection.runs == ROLLING:
        return True
    beside = runs.touching(session, machine_id, revision=revision, first=first - BESIDE, last=last + BESIDE)
    before = round(1e9 * machine.collection.pre_trigger_s)
    # So near to a run they may lengthen it.
    near = max(OperatingLimits.of(machine).sweep.gap, before)
    if any(row.state == runs.OPEN or (_holds(row, first - near, last + near) and _waits(row, patience_s)) for row in beside):
        return False
    if beside and (machines.get(session, machine_id).blocks_since or 0) > beside[0].time_first:
        _leave_out(beside, count, "were let go of")
        return True
    begin = min([first, *(row.time_first for row in beside)]) - BESIDE
    end = max([last, *(row.time_last or row.time_first for row in beside)]) + BESIDE

    def concerned(start: int, stop: int) -> bool:
        return start - before <= last and stop >= first

    damaged: list[str] = []
    sweeps = _sweeps(session, machine, revision, begin, end, damaged)
    if beside and damaged:
        _leave_out(beside, count, "cannot all be read any more")
        tell_damaged(session, beside[0], damaged)
        return True
    left = list(beside)
    for sweep, direction in sweeps:
        if not concerned(sweep.start, sweep.time):
            continue
        known = [row for row in left if row.kind == sweep.kind and _overlap(row, sweep)]
        left = [row for row in left if row not in known]
        if not known:
            _add(session, machine, revision, direction, sweep)
            continue
        _reopen(session, machine, known[0], sweep)
        for other in known[1:]:
            other.state, other.reason = runs.DISCARDED, f"late samples join it to run {known[0].id}"
    for row in left:
        # With the late samples the sweep looks otherwise; it keeps its bounds and gets its samples.
        same = RunEnded(row.time_first, row.time_last or row.time_first, _kind(row), row.reason or "")
        if concerned(same.start, same.time):
            _reopen(session, machine, row, same)
    return True


def _leave_out(beside: Sequence[RunRow], count: int, words: str) -> None:
    """Made anew from the blocks that are left, runs would lose what they have."""
    for row in beside:
        runs.leave_out(row, count)
    logger.warning("%s: %d samples came too late for their run, whose blocks %s", beside[0].machine_id, count, words)


def _holds(row: RunRow, first: int, last: int) -> bool:
    """Whether some of the time from first to last [ns] is a run's."""
    return row.time_first <= last and (row.time_last or row.time_first) >= first


def _waits(row: RunRow, patience_s: float) -> bool:
    """Whether a run was made anew so short a time ago that more may come."""
    if row.reopened_at is None:
        return False
    return now() < row.reopened_at + 1e9 * patience_s * 2.0 ** (row.times_reopened or 0)


def _kind(row: RunRow) -> RunKind:
    return "run-up" if row.kind == "run-up" else "run-down"


def _overlap(row: RunRow, sweep: RunEnded) -> bool:
    return _holds(row, sweep.start, sweep.time)


def _sweeps(
    session: Session, machine: Machine, revision: int, begin: int, end: int, damaged: list[str]
) -> list[tuple[RunEnded, int]]:
    """The sweeps between two times [ns] as the store now tells them, each with its sense of rotation. damaged: gets what is
    wrong with blocks that are left out.
    """
    held = samples.between(
        session,
        machine.id,
        revision=revision,
        channels=len(machine.probes),
        first=begin,
        last=end,
        largest=LARGEST_READ,
        damaged=damaged,
    )
    _, first = np.unique(held.time, return_index=True)
    held = held.pick(first)
    state, limits = OperatingState(), OperatingLimits.of(machine)
    found: list[tuple[RunEnded, int]] = []
    turning = 1
    for moment, speed, direction in zip(held.time.tolist(), held.speed.tolist(), held.direction.tolist(), strict=True):
        state, events = advance(state, limits, time=moment, speed=speed, direction=direction)
        found += [(event, turning) for event in events if isinstance(event, RunEnded)]
        turning = direction
    _, events = silence(state, limits, reason="no more samples came")
    return [*found, *((event, turning) for event in events if isinstance(event, RunEnded))]


def _add(session: Session, machine: Machine, revision: int, direction: int, sweep: RunEnded) -> None:
    """A run that nobody knew of."""
    row = runs.open_run(session, machine.id, revision=revision, kind=sweep.kind, direction=direction, time_first=sweep.start)
    close_sweep(session, machine, row, first=sweep.start, last=sweep.time, reason=f"{sweep.reason}; it came late")


def _reopen(session: Session, machine: Machine, row: RunRow, sweep: RunEnded) -> None:
    """Make a closed run anew with what came late."""
    row.reopened_at, row.times_reopened = now(), (row.times_reopened or 0) + 1
    if sweep.start != row.time_first:
        row.time_first = runs.free_start(session, machine.id, sweep.start)
    row.time_last = None  # so that it does not count as the run before itself
    session.flush()
    reason = sweep.reason.split("; not identified")[0]
    close_sweep(session, machine, row, first=sweep.start, last=sweep.time, reason=reason)
