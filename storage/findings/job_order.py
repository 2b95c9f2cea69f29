"""Order of the identification jobs: which waiting job is taken next, whichever replica takes it.

1. Jobs are ordered by priority, over all plants. First come jobs that the service itself requests (AUTOMATIC: a run was
closed, runs are pooled), since alerts depend on them. Then come single identifications requested by a person (ASKED), then
bulk requests (RECOMPUTED), last jobs that crashed their process or exceeded its time or memory (TRIED). Requests by people of
one plant thus delay no automatic job of another plant.

2. Within a priority the plants take turns of one job each: a plant with a single job waits for at most one job of each other
plant, however many those have queued.

3. Within a turn, and within a plant, the oldest job comes first.

Two rules complement the order. The last free process of a replica with two or more is reserved for automatic jobs (`behind`),
so that they need not wait for a long requested one. A job that has waited longer than OVERDUE_S behind better priorities is
taken once in every OVERDUE_SHARE jobs, so that none waits for ever.

Turns are fair queueing by virtual start times: a queued job gets the `turn` after its plant's newest job, but none before the
turn that is being computed. All of this is stored in the rows, and taking the next jobs reads only as many rows from an index
as it takes. The service limits how many jobs a person may have waiting.
"""

from collections.abc import Sequence

from sqlalchemy import ColumnElement, UnaryExpression, select
from sqlalchemy.orm import Session

from storage.clock import now
from storage.database.plant_scope import EVERY_PLANT
from storage.tables.findings import JobRow

QUEUED, RUNNING = "queued", "running"
AUTOMATIC, ASKED, RECOMPUTED, TRIED = range(4)
OVERDUE_S = 3600.0
OVERDUE_SHARE = 10


def next_turn(session: Session, plant: str, priority: int) -> int:
    """Return the turn of a job that a plant queues now."""
    newest, oldest = JobRow.turn.desc(), JobRow.turn.asc()
    present = _turn(session, RUNNING, newest, priority=priority)
    if present is None:
        present = _turn(session, QUEUED, oldest, priority=priority)
    own = [_turn(session, state, newest, priority=priority, plant=plant) for state in (QUEUED, RUNNING)]
    return max([present or 0, *(turn + 1 for turn in own if turn is not None)])


def next_jobs(session: Session, limit: int, *, behind: int, overdue: bool) -> list[JobRow]:
    """Return the next jobs in order, at most `limit`, and lock them; jobs locked by others are skipped.

    behind: how many of them may be other than automatic. overdue: whether a job that has waited too long comes first.
    """
    rows = _overdue(session) if overdue and limit > 0 and behind > 0 else []
    rows += _take_queued(session, JobRow.priority == AUTOMATIC, limit - len(rows))
    others = min(limit - len(rows), behind - sum(row.priority != AUTOMATIC for row in rows))
    known = [row.id for row in rows if row.priority != AUTOMATIC]
    return [*rows, *_take_queued(session, (JobRow.priority > AUTOMATIC) & JobRow.id.not_in(known), others)]


def _overdue(session: Session) -> list[JobRow]:
    """Return the job that has waited longest among the first of each priority, if it is overdue."""
    first = [row for priority in (ASKED, RECOMPUTED, TRIED) for row in _take_queued(session, JobRow.priority == priority, 1)]
    late = [row for row in first if row.created_at < now() - int(1e9 * OVERDUE_S)]
    return sorted(late, key=lambda row: row.created_at)[:1]


def _take_queued(session: Session, which: ColumnElement[bool], limit: int) -> Sequence[JobRow]:
    if limit <= 0:
        return []
    query = select(JobRow).where(JobRow.state == QUEUED, which)
    query = query.order_by(JobRow.priority, JobRow.turn, JobRow.id).limit(limit)
    return session.scalars(query.with_for_update(skip_locked=True)).all()


def _turn(session: Session, state: str, order: UnaryExpression[int], **like: object) -> int | None:
    """Return the first turn, in the given order, of the jobs in a state.

    Turns are shared by all plants, so jobs of every plant count, whoever asks. The query avoids max() and min(), for which
    PostgreSQL reads all rows where it expects few.
    """
    query = select(JobRow.turn).filter_by(state=state, **like).order_by(order).limit(1)
    return session.scalar(query, execution_options=EVERY_PLANT)
