"""Repository of identification jobs: a queue that survives restarts."""

import hashlib
import json
from collections.abc import Collection, Sequence
from typing import Any

from sqlalchemy import ColumnElement, func, select
from sqlalchemy.orm import Session

from estimator.errors import Missing
from storage.clock import now
from storage.database.plant_scope import EVERY_PLANT
from storage.encoding.text import plain_text
from storage.findings.job_order import AUTOMATIC, TRIED, next_jobs, next_turn
from storage.findings.job_order import QUEUED as QUEUED
from storage.findings.job_order import RUNNING as RUNNING
from storage.machines import machines
from storage.paging import Keys, ordered
from storage.tables.findings import DONE as DONE
from storage.tables.findings import FAILED as FAILED
from storage.tables.findings import QUARANTINED as QUARANTINED
from storage.tables.findings import JobRow
from storage.tables.operation import ReplicaRow

STATES = (QUEUED, RUNNING, DONE, FAILED, QUARANTINED)

RUN, GATHERED, VARIANT, CALIBRATION = "run", "gathered", "variant", "calibration"
"""Scope of a job: one run as usual, the newest runs pooled, one run with other options, which no trend follows, or a
calibration of the model from runs with known unbalances."""

LARGEST_ATTEMPTS = 3
LONGEST_LIST = 120
"""Characters of a request's list of runs beyond which a checksum stands for it."""


class JobUnknown(Missing):
    """Raised when no job has this id."""

    subject = "job"


def enqueue(
    session: Session,
    machine_id: str,
    *,
    scope: str,
    run_ids: list[int],
    options: dict[str, Any] | None = None,
    asked_by: str | None = None,
    priority: int = AUTOMATIC,
) -> JobRow | None:
    """Queue an identification of these runs; return None when it was requested before with the same options.

    asked_by: identity of the person who requests it; priority: see `storage.findings.job_order`. Raises MachineUnknown.
    """
    if find_request(session, scope=scope, run_ids=run_ids, options=options) is not None:
        return None
    plant = machines.get(session, machine_id).plant
    row = JobRow(
        machine_id=machine_id,
        plant=plant,
        priority=priority,
        turn=next_turn(session, plant, priority),
        asked_by=asked_by,
        scope=scope,
        run_ids=run_ids,
        request=_request(scope, run_ids, options),
        state=QUEUED,
        attempts=0,
        created_at=now(),
        finished_at=None,
        error=None,
        options=options or None,
    )
    session.add(row)
    session.flush()
    return row


def find_request(session: Session, *, scope: str, run_ids: list[int], options: dict[str, Any] | None = None) -> JobRow | None:
    """Return the job that was requested with the same runs and options; None when there is none."""
    return session.scalars(select(JobRow).where(JobRow.request == _request(scope, run_ids, options))).first()


def _request(scope: str, run_ids: list[int], options: dict[str, Any] | None) -> str:
    listed = ",".join(map(str, sorted(run_ids)))
    request = f"{scope}:{listed if len(listed) <= LONGEST_LIST else _checksum(listed)}"
    return f"{request}:{_checksum(json.dumps(options, sort_keys=True))}" if options else request


def _checksum(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:32]


def claim_next(
    session: Session, limit: int, *, holder: int | None = None, behind: int | None = None, overdue: bool = False
) -> Sequence[JobRow]:
    """Mark the next jobs by `storage.findings.job_order` as running and return them.

    holder: number of the replica, which gets no jobs when it has been declared dead meanwhile. behind, overdue: as of
    `next_jobs`.
    """
    if holder is not None and session.get(ReplicaRow, holder) is None:
        return []
    rows = next_jobs(session, limit, behind=limit if behind is None else behind, overdue=overdue)
    for row in rows:
        row.state = RUNNING
        row.attempts += 1
        row.holder = holder
    return rows


def finish(row: JobRow, *, state: str, error: str | None = None) -> None:
    """Record how a job ended: DONE, FAILED or QUARANTINED with the reason."""
    # What was raised may quote what came from outside.
    row.state, row.error, row.finished_at = state, None if error is None else plain_text(error), now()


def requeue(session: Session, row: JobRow, error: str) -> None:
    """Queue a job again that crashed its worker or exceeded a limit; quarantine it after LARGEST_ATTEMPTS attempts."""
    if row.attempts >= LARGEST_ATTEMPTS:
        finish(row, state=QUARANTINED, error=f"given up after {row.attempts} attempts: {error}")
    else:
        row.turn, row.priority = next_turn(session, row.plant, TRIED), TRIED
        row.state, row.holder = QUEUED, None


def requeue_uncounted(row: JobRow) -> None:
    """Queue a job again in its old turn, without counting the attempt: its worker ended for a reason that is not the job's."""
    row.state, row.attempts, row.holder = QUEUED, max(0, row.attempts - 1), None


def requeue_running(session: Session, *, living: Collection[int] = ()) -> int:
    """Queue running jobs again whose replica is not alive; return their number."""
    rows = [row for row in session.scalars(select(JobRow).where(JobRow.state == RUNNING)) if row.holder not in living]
    for row in rows:
        requeue_uncounted(row)
    return len(rows)


def held_by(session: Session, holder: int | None) -> Sequence[JobRow]:
    """Return the jobs that a replica is computing; holder None: the only process on its database."""
    return session.scalars(select(JobRow).where(JobRow.state == RUNNING, JobRow.holder == holder)).all()


def any_waiting(session: Session, *, automatic: bool = False) -> bool:
    """Return whether any job is queued; automatic: count only those that no person requested."""
    query = select(JobRow.id).where(JobRow.state == QUEUED)
    if automatic:
        query = query.where(JobRow.priority == AUTOMATIC)
    return session.scalars(query.limit(1)).first() is not None


def count_waiting_of(session: Session, *, asked_by: str, most: int) -> int:
    """Return how many jobs requested by somebody are queued, of any plant; counts up to `most`."""
    return _counted(session, JobRow.asked_by == asked_by, most)


def count_requested_of_machine(session: Session, machine_id: str, *, most: int) -> int:
    """Return how many jobs of a machine requested by people are queued; counts up to `most`."""
    return _counted(session, (JobRow.machine_id == machine_id) & JobRow.asked_by.is_not(None), most)


def _counted(session: Session, which: ColumnElement[bool], most: int) -> int:
    rows = select(JobRow.id).where(JobRow.state == QUEUED, which).limit(most).subquery()
    return session.scalar(select(func.count()).select_from(rows), execution_options=EVERY_PLANT) or 0


def get(session: Session, job_id: int) -> JobRow:
    """Return a job by id; raise JobUnknown when there is none."""
    row = session.get(JobRow, job_id)
    if row is None:
        raise JobUnknown(job_id)
    return row


def of_machine(session: Session, machine_id: str, *, limit: int, after: Keys | None = None) -> Sequence[JobRow]:
    """Return the jobs of a machine, newest first. after: id of the last one of the page before."""
    query = ordered(select(JobRow).where(JobRow.machine_id == machine_id), (JobRow.id,), after)
    return session.scalars(query.limit(limit)).all()


def count(session: Session) -> dict[str, int]:
    """Return the number of jobs in each state."""
    query = select(JobRow.state, func.count()).group_by(JobRow.state)
    return {state: number for state, number in session.execute(query)}  # noqa: C416 - dict() loses the types
