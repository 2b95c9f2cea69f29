"""Retention: deleting sample blocks, and then the samples of runs, that are old enough. Everything else is kept for ever.

Each call is part of a small transaction of its own, so that ingest never waits long for it.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from sqlalchemy import Select, delete, func, select, update
from sqlalchemy.orm import Session

from storage.clock import now
from storage.findings.jobs import QUEUED, RUNNING
from storage.machines import machines
from storage.tables.findings import IdentificationRow, JobRow
from storage.tables.machines import BaselineRow
from storage.tables.measurements import RunRow, SampleBlockRow
from storage.tables.operation import RetentionRow

KEPT_RUNS = 20
"""Number of a machine's newest runs that always keep their samples: they may still be identified together."""


@dataclass(frozen=True)
class Extent:
    """A number of blocks or runs, and the time that they cover [ns]."""

    count: int
    first: int
    last: int


def cut_off(session: Session, tier: str) -> tuple[int, int] | None:
    """Return cut-off and allowance of a tier [ns]; None before any was stored."""
    row = session.get(RetentionRow, tier)
    return None if row is None else (row.cut_off, row.allowance)


def store_cut_off(session: Session, tier: str, *, time: int, allowance: int) -> None:
    """Store cut-off and allowance of a tier [ns]."""
    session.merge(RetentionRow(tier=tier, cut_off=time, allowance=allowance))


def is_empty(session: Session) -> bool:
    """Return whether no samples are stored, neither as received nor in runs."""
    return not any(session.scalar(select(column).limit(1)) is not None for column in (SampleBlockRow.id, RunRow.id))


def newest_sample(session: Session, machine_id: str) -> int | None:
    """Return the time of a machine's newest sample [ns]; None when it has none."""
    return session.scalar(select(func.max(SampleBlockRow.time_last)).where(SampleBlockRow.machine_id == machine_id))


def has_blocks(session: Session, machine_id: str, *, before: int) -> bool:
    """Return whether a machine has sample blocks that ended before a time [ns]."""
    return session.scalar(_ended_blocks(machine_id, before).limit(1)) is not None


def release_blocks(session: Session, machine_id: str, *, before: int, limit: int) -> int:
    """Delete at most `limit` of the oldest sample blocks of a machine that ended before a time [ns]; return their number.

    The machine's row records how far back its blocks reach.
    """
    block = SampleBlockRow
    rows = session.execute(_ended_blocks(machine_id, before).order_by(block.time_last, block.id).limit(limit)).all()
    if rows:
        session.execute(delete(block).where(block.id.in_([number for number, _ in rows])))
        machine = machines.get(session, machine_id)
        machine.blocks_since = max(machine.blocks_since or 0, rows[-1].time_last + 1)
    return len(rows)


def extent_of_blocks(session: Session, machine_id: str, *, before: int) -> Extent | None:
    """Return the extent of a machine's sample blocks that ended before a time [ns]; None when there are none."""
    block = SampleBlockRow
    query = select(func.count(), func.min(block.time_first), func.max(block.time_last))
    count, first, last = session.execute(query.where(block.machine_id == machine_id, block.time_last < before)).one()
    return Extent(count, first, last) if count else None


def _ended_blocks(machine_id: str, before: int) -> Select[int, int]:
    block = SampleBlockRow
    return select(block.id, block.time_last).where(block.machine_id == machine_id, block.time_last < before)


def has_runs(session: Session, machine_id: str, *, before: int, baseline_runs: int) -> bool:
    """Return whether `release_runs` would delete anything."""
    ended = _ended_runs(machine_id, before)
    if session.scalar(ended.limit(1)) is None:
        return False
    needed = needed_runs(session, machine_id, baseline_runs=baseline_runs)
    return session.scalar(ended.where(RunRow.id.not_in(needed)).limit(1)) is not None


def extent_of_runs(session: Session, machine_id: str, *, before: int, baseline_runs: int) -> Extent | None:
    """Return the extent of the runs whose samples `release_runs` would delete; None when there are none."""
    needed = needed_runs(session, machine_id, baseline_runs=baseline_runs)
    ended = _ended_runs(machine_id, before).where(RunRow.id.not_in(needed)).subquery()
    query = select(func.count(), func.min(RunRow.time_first), func.max(RunRow.time_last))
    count, first, last = session.execute(query.where(RunRow.id.in_(select(ended.c.id)))).one()
    return Extent(count, first, last or first) if count else None


def release_runs(session: Session, machine_id: str, *, before: int, baseline_runs: int, limit: int) -> int:
    """Delete the samples of at most `limit` runs that ended before a time [ns] and are not needed, oldest first.

    The rows of the runs stay. baseline_runs: as in `needed_runs`. Returns the number of runs.
    """
    run = RunRow
    needed = needed_runs(session, machine_id, baseline_runs=baseline_runs)
    old = session.scalars(
        _ended_runs(machine_id, before).where(run.id.not_in(needed)).order_by(run.time_first).limit(limit).with_for_update()
    ).all()
    # Until they were locked, late samples may have reopened one.
    still = set(old) - needed_runs(session, machine_id, baseline_runs=baseline_runs)
    session.execute(update(run).where(run.id.in_(still)).values(data=None, flags=None, released_at=now()))
    return len(old)


def _ended_runs(machine_id: str, before: int) -> Select[int]:
    run = RunRow
    return select(run.id).where(run.machine_id == machine_id, run.data.is_not(None), run.time_last < before)


def needed_runs(session: Session, machine_id: str, *, baseline_runs: int) -> set[int]:
    """Return the runs whose samples are still needed: the newest, those awaiting an identification, those of a baseline.

    baseline_runs: number of identifications that form a baseline without named ones.
    """
    run, job = RunRow, JobRow
    newest = select(run.id).where(run.machine_id == machine_id).order_by(run.time_first.desc()).limit(KEPT_RUNS)
    waiting = select(job.run_ids).where(job.machine_id == machine_id, job.state.in_((QUEUED, RUNNING)))
    found = set(session.scalars(newest))
    for run_ids in [*session.scalars(waiting), *_of_baselines(session, machine_id, baseline_runs)]:
        found |= set(run_ids)
    return found


def _of_baselines(session: Session, machine_id: str, baseline_runs: int) -> Sequence[list[int]]:
    """Return the runs of the identifications that form baselines, including the one of the machine's first runs."""
    begun = session.scalars(select(BaselineRow).where(BaselineRow.machine_id == machine_id)).all()
    made = IdentificationRow
    named = [number for row in begun for number in row.identification_ids or ()]
    found = list(session.scalars(select(made.run_ids).where(made.machine_id == machine_id, made.id.in_(named))))
    place = func.row_number().over(
        partition_by=(made.revision, made.scope, made.run_kind, made.slow_roll_version, made.load_balance),
        order_by=(made.measured_at, made.id),
    )
    for since in [0, *(row.since for row in begun if row.identification_ids is None)]:
        accepted = select(made.run_ids, place.label("place")).where(
            made.machine_id == machine_id, made.accepted, made.measured_at >= since
        )
        first = accepted.subquery()
        found += session.scalars(select(first.c.run_ids).where(first.c.place <= baseline_runs))
    return found
