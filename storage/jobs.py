"""Repository of identification jobs: a queue that survives restarts."""

import hashlib
import json
from collections.abc import Sequence
from typing import Any

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from storage.clock import now
from storage.paging import Keys, ordered
from storage.tables import JobRow

QUEUED, RUNNING, DONE, FAILED = "queued", "running", "done", "failed"

RUN, GATHERED, VARIANT = "run", "gathered", "variant"
"""Scope of a job: one run as usual, the newest runs gathered so far, or one run with other options, which no trend follows."""

LARGEST_ATTEMPTS = 3


class JobUnknown(KeyError):
    """No job of that id."""


def ask(
    session: Session, machine_id: str, *, scope: str, run_ids: list[int], options: dict[str, Any] | None = None
) -> JobRow | None:
    """Queue an identification of these runs; None when the same was asked for before, with the same options."""
    if asked(session, scope=scope, run_ids=run_ids, options=options) is not None:
        return None
    row = JobRow(
        machine_id=machine_id,
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


def asked(session: Session, *, scope: str, run_ids: list[int], options: dict[str, Any] | None = None) -> JobRow | None:
    """The job that was asked for with the same runs and options."""
    return session.scalars(select(JobRow).where(JobRow.request == _request(scope, run_ids, options))).first()


def _request(scope: str, run_ids: list[int], options: dict[str, Any] | None) -> str:
    request = f"{scope}:{','.join(map(str, sorted(run_ids)))}"
    if options:
        request += ":" + hashlib.sha256(json.dumps(options, sort_keys=True).encode()).hexdigest()[:32]
    return request


def take(session: Session, limit: int) -> Sequence[JobRow]:
    """The oldest queued jobs, marked as running."""
    rows = session.scalars(select(JobRow).where(JobRow.state == QUEUED).order_by(JobRow.id).limit(limit)).all()
    for row in rows:
        row.state = RUNNING
        row.attempts += 1
    return rows


def finish(row: JobRow, *, state: str, error: str | None = None) -> None:
    """Record how a job ended: DONE, or FAILED with the reason."""
    row.state, row.error, row.finished_at = state, error, now()


def put_back(row: JobRow, error: str) -> None:
    """Queue a job again after its worker was lost; a job that has cost several workers fails."""
    if row.attempts >= LARGEST_ATTEMPTS:
        finish(row, state=FAILED, error=f"given up after {row.attempts} attempts: {error}")
    else:
        row.state = QUEUED


def put_back_running(session: Session) -> int:
    """At start: queue again what an earlier process left running. Returns how many."""
    rows = session.scalars(select(JobRow).where(JobRow.state == RUNNING)).all()
    for row in rows:
        # A stop of the service says nothing against the job.
        row.state, row.attempts = QUEUED, max(0, row.attempts - 1)
    return len(rows)


def waiting(session: Session) -> bool:
    """Whether any job is queued."""
    return session.scalars(select(JobRow.id).where(JobRow.state == QUEUED).limit(1)).first() is not None


def get(session: Session, job_id: int) -> JobRow:
    """Raises JobUnknown."""
    row = session.get(JobRow, job_id)
    if row is None:
        raise JobUnknown(job_id)
    return row


def of_machine(session: Session, machine_id: str, *, limit: int, after: Keys | None = None) -> Sequence[JobRow]:
    """The newest jobs of a machine, newest first; after: id of the one before."""
    query = ordered(select(JobRow).where(JobRow.machine_id == machine_id), (JobRow.id,), after)
    return session.scalars(query.limit(limit)).all()


def count(session: Session) -> dict[str, int]:
    """How many jobs are in each state."""
    query = select(JobRow.state, func.count()).group_by(JobRow.state)
    return {state: number for state, number in session.execute(query)}  # noqa: C416 - dict() loses the types
