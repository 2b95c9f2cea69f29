"""Late samples, which come after run collection has passed their time: sorted into the runs that they belong to.

The stretch of time in which they lie is evaluated again, from the store and with the same state machine. A sweep found there
that was collected before is reopened: rebuilt with all its samples and identified again. An unknown sweep, such as a whole
run-down after an hour without a network, becomes a run of its own. Each time a run was reopened it waits twice as long for
more: samples that trickle in over a day cost a dozen identifications, not one each.

`plan` reads and decides, which may take seconds; `apply` then writes the result quickly.
"""

import logging
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from sqlalchemy.orm import Session

from estimator.machine.document import Machine
from estimator.runs.operating_state import OperatingLimits, OperatingState, advance, silence
from estimator.runs.segmentation import RunEnded, RunKind
from estimator.runs.speed_bins import ROLLING
from service.resilience.internal_errors import damaged_blocks
from service.runs.run_samples import largest_read
from storage.clock import now
from storage.machines import machines
from storage.measurements import quarantine, runs, samples
from storage.tables.measurements import RunRow

logger = logging.getLogger(__name__)

Window = list[int]
"""Revision of the document, first and last time of late samples [ns], and their number."""

BESIDE = 120_000_000_000
"""Late samples this near to each other [ns] are evaluated together, with the known samples this near to them."""
LARGEST_COUNT = 100
"""Windows recorded per machine; beyond it the two oldest are merged."""


def add_late(windows: list[Window], revision: int, times: list[int]) -> list[Window]:
    """Return the windows extended by more late samples, ascending."""
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


@dataclass(frozen=True)
class LateSamplesPlan:
    """Changes to the runs of a machine that follow from the samples of one window.

    added: unknown sweeps, with their sense of rotation. remade: runs to be rebuilt, by id, with the sweep that each is now.
    joined: runs that become part of another one, by id. left_out: runs that cannot be rebuilt; why: the reason; damaged:
    faults of the blocks needed. basis: the state it relies on, see `is_plan_current`.
    """

    machine_id: str
    window: Window
    added: list[tuple[RunEnded, int]] = field(default_factory=list)
    remade: dict[int, RunEnded] = field(default_factory=dict)
    joined: dict[int, int] = field(default_factory=dict)
    left_out: list[int] = field(default_factory=list)
    why: str = ""
    damaged: list[str] = field(default_factory=list)
    basis: tuple[object, ...] = ()


def by_run(session: Session, machine_id: str, windows: Sequence[Window]) -> list[Window]:
    """Return the windows, ascending; all windows within one run are merged, so that the run is rebuilt only once."""
    merged: list[Window] = []
    inside: set[int] = set()
    for window in windows:
        revision, first, last, _ = window
        here = {row.id for row in runs.overlapping(session, machine_id, revision=revision, first=first, last=last)}
        if merged and merged[-1][0] == revision and here & inside:
            merged[-1] = _joined(merged[-1], window)
            inside |= here
        else:
            merged.append(window)
            inside = here
    return merged


def remove_window(windows: Sequence[Window], window: Window) -> list[Window] | None:
    """Return the windows left after sorting in one of `by_run`; None when more samples came into it since."""
    revision, first, last, count = window
    inside = [one for one in windows if one[0] == revision and one[1] <= last and one[2] >= first]
    if sum(one[3] for one in inside) != count or any(one[1] < first or one[2] > last for one in inside):
        return None
    return [one for one in windows if one not in inside]


def plan(session: Session, machine_id: str, window: Window, *, patience_s: float) -> LateSamplesPlan | None:
    """Return the changes for the samples of a window; None when they must wait.

    They wait until a neighbouring run is closed, and for some time after a run was rebuilt: `patience_s` after the first
    time, then twice as long each time.
    """
    revision, first, last, _ = window
    machine = machines.document(session, machine_id, revision)
    found = LateSamplesPlan(machine_id, window, basis=_basis(session, machine_id, window))
    if machine.collection.runs == ROLLING:
        return found
    beside = runs.overlapping(session, machine_id, revision=revision, first=first - BESIDE, last=last + BESIDE)
    before = round(1e9 * machine.collection.pre_trigger_s)
    # So near to a run they may lengthen it.
    near = max(OperatingLimits.of(machine).sweep.gap, before)
    if any(_must_wait(row, first - near, last + near, patience_s) for row in beside):
        return None
    if beside and (machines.get(session, machine_id).blocks_since or 0) > beside[0].time_first:
        return replace(found, left_out=[row.id for row in beside], why="were deleted")
    sweeps = _sweeps(session, machine, revision, *_evaluated_stretch(window, beside), found.damaged)
    if beside and found.damaged:
        return replace(found, left_out=[row.id for row in beside], why="cannot all be read any more")
    _match(found, beside, sweeps, before)
    return found


def _must_wait(row: RunRow, first: int, last: int, patience_s: float) -> bool:
    """Return whether late samples from first to last [ns] must wait for a run."""
    return _is_unfinished(row) or (_overlaps(row, first, last) and _waits(row, patience_s))


def _evaluated_stretch(window: Window, beside: Sequence[RunRow]) -> tuple[int, int]:
    """Return the first and last time that are evaluated again [ns]: around the window and the runs beside it."""
    _, first, last, _ = window
    begin = min([first, *(row.time_first for row in beside)]) - BESIDE
    end = max([last, *(row.time_last or row.time_first for row in beside)]) + BESIDE
    return begin, end


def is_plan_current(session: Session, found: LateSamplesPlan) -> bool:
    """Return whether the runs beside a window, and how far back the blocks reach, are unchanged since the plan."""
    return found.basis == _basis(session, found.machine_id, found.window)


def _basis(session: Session, machine_id: str, window: Window) -> tuple[object, ...]:
    revision, first, last, _ = window
    beside = runs.overlapping(session, machine_id, revision=revision, first=first - BESIDE, last=last + BESIDE)
    known = [(row.id, row.state, row.time_first, row.time_last, row.times_reopened) for row in beside]
    return machines.get(session, machine_id).blocks_since, *known


def _match(found: LateSamplesPlan, beside: Sequence[RunRow], sweeps: Sequence[tuple[RunEnded, int]], before: int) -> None:
    """Add to a plan which runs the sweeps found now rebuild, join, or add. before: length of what a run has before its sweep
    [ns]."""
    _, first, last, _ = found.window

    def concerned(sweep: RunEnded) -> bool:
        return sweep.start - before <= last and sweep.time >= first

    left = list(beside)
    for sweep, direction in sweeps:
        if not concerned(sweep):
            continue
        known = [row for row in left if row.kind == sweep.kind and _overlap(row, sweep)]
        left = [row for row in left if row not in known]
        if not known:
            found.added.append((sweep, direction))
            continue
        found.remade[known[0].id] = sweep
        found.joined.update({other.id: known[0].id for other in known[1:]})
    for row in left:
        # With the late samples the sweep looks otherwise; it keeps its bounds and gets its samples.
        same = RunEnded(row.time_first, row.time_last or row.time_first, _kind(row), row.reason or "")
        if concerned(same):
            found.remade[row.id] = same


def apply(session: Session, found: LateSamplesPlan) -> None:
    """Apply a plan; added and rebuilt runs are then ended, and get their samples when they are closed."""
    machine_id, (revision, _, _, count) = found.machine_id, found.window
    for run_id in found.left_out:
        # Made anew from the blocks that are left, runs would lose what they have.
        runs.add_left_out_samples(runs.get(session, run_id), count)
    if found.left_out:
        logger.warning("%s: %d samples came too late for their run, whose blocks %s", machine_id, count, found.why)
        told = damaged_blocks(found.damaged, run_id=found.left_out[0], machine_id=machine_id)
        quarantine.add(session, told)
        return
    for sweep, direction in found.added:
        row = runs.open_run(
            session, machine_id, revision=revision, kind=sweep.kind, direction=direction, time_first=sweep.start
        )
        runs.end(row, first=sweep.start, last=sweep.time, reason=f"{sweep.reason}; it came late")
    for run_id, sweep in found.remade.items():
        _reopen(session, runs.get(session, run_id), sweep)
    for run_id, other in found.joined.items():
        row = runs.get(session, run_id)
        row.state, row.reason = runs.DISCARDED, f"late samples join it to run {other}"


def _is_unfinished(row: RunRow) -> bool:
    """Return whether a run does not have its samples yet."""
    return row.state in (runs.OPEN, runs.ENDED)


def _overlaps(row: RunRow, first: int, last: int) -> bool:
    """Return whether a run overlaps the time from first to last [ns]."""
    return row.time_first <= last and (row.time_last or row.time_first) >= first


def _waits(row: RunRow, patience_s: float) -> bool:
    """Return whether a run was rebuilt so recently that more samples may come."""
    if row.reopened_at is None:
        return False
    return now() < row.reopened_at + 1e9 * patience_s * 2.0 ** (row.times_reopened or 0)


def _kind(row: RunRow) -> RunKind:
    return "run-up" if row.kind == "run-up" else "run-down"


def _overlap(row: RunRow, sweep: RunEnded) -> bool:
    return _overlaps(row, sweep.start, sweep.time)


def _sweeps(
    session: Session, machine: Machine, revision: int, begin: int, end: int, damaged: list[str]
) -> list[tuple[RunEnded, int]]:
    """Return the sweeps between two times [ns] as now stored, each with its sense of rotation.

    damaged: receives the faults of blocks that are left out.
    """
    held = samples.between(
        session,
        machine.id,
        revision=revision,
        channels=len(machine.probes),
        first=begin,
        last=end,
        largest=largest_read(len(machine.probes)),
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


def _reopen(session: Session, row: RunRow, sweep: RunEnded) -> None:
    """Reopen a closed run to be rebuilt with late samples."""
    row.reopened_at, row.times_reopened = now(), (row.times_reopened or 0) + 1
    if sweep.start != row.time_first:
        row.time_first = runs.free_start(session, row.machine_id, sweep.start)
    runs.end(row, first=sweep.start, last=sweep.time, reason=sweep.reason.split("; not identified")[0])
