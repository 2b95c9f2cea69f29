"""The scheduler of identification jobs: which of those that wait is taken next, whichever replica takes it.

The order:

1. By priority, over all plants. First what the service asks for by itself (AUTOMATIC: a run was closed, runs are gathered):
   alerts follow from it. Then single identifications that a person asks for (ASKED), then many at once (RECOMPUTED), last what
   has cost its process its life, or more time or memory than it may (TRIED). So what people of one plant ask for keeps no
   automatic job of another plant waiting.
2. Within a priority the plants take turns, a job each: one with a single job waits for one job of each other plant at most,
   however many those have waiting.
3. Within a turn, and within a plant, the oldest first.

Two rules beside it. The last free process of a replica is kept for automatic jobs (`behind`, where there are two processes or
more): they need not wait until something long that was asked for is computed either. And what has waited for OVERDUE_S behind
better priorities is taken all the same, once in OVERDUE_SHARE jobs, so that nothing waits for ever.

Turns are fair queueing (start times of virtual time): a job gets its `turn` when it is queued, the one behind its plant's
newest job, but none before the turn that is being computed now. All of this stands in the rows, and taking the next jobs reads
as many rows from an index as it takes. The service bounds how many jobs a person may have waiting.
"""

from collections.abc import Sequence

from sqlalchemy import ColumnElement, UnaryExpression, select
from sqlalchemy.orm import Session

from storage.clock import now
from storage.database.plant_scope import EVERY_PLANT
from storage.tables import JobRow

QUEUED, RUNNING = "queued", "running"
AUTOMATIC, ASKED, RECOMPUTED, TRIED = range(4)
OVERDUE_S = 3600.0
OVERDUE_SHARE = 10


def next_turn(session: Session, plant: str, priority: int) -> int:
    """The turn of a job that a plant queues now."""
    newest, oldest = JobRow.turn.desc(), JobRow.turn.asc()
    present = _turn(session, RUNNING, newest, priority=priority)
    if present is None:
        present = _turn(session, QUEUED, oldest, priority=priority)
    own = [_turn(session, state, newest, priority=priority, plant=plant) for state in (QUEUED, RUNNING)]
    return max([present or 0, *(turn + 1 for turn in own if turn is not None)])


def next_jobs(session: Session, limit: int, *, behind: int, overdue: bool) -> list[JobRow]:
    """At most `limit` jobs in their order, which nobody else is taking.

    behind: how many of them may be other than automatic. overdue: whether one of these comes first that has waited too long.
    """
    rows = _overdue(session) if overdue and limit > 0 and behind > 0 else []
    rows += _taken(session, JobRow.priority == AUTOMATIC, limit - len(rows))
    others = min(limit - len(rows), behind - sum(row.priority != AUTOMATIC for row in rows))
    known = [row.id for row in rows if row.priority != AUTOMATIC]
    return [*rows, *_taken(session, (JobRow.priority > AUTOMATIC) & JobRow.id.not_in(known), others)]


def _overdue(session: Session) -> list[JobRow]:
    """The one of the first jobs of each priority that has waited longest, if that is too long."""
    first = [row for priority in (ASKED, RECOMPUTED, TRIED) for row in _taken(session, JobRow.priority == priority, 1)]
    late = [row for row in first if row.created_at < now() - int(1e9 * OVERDUE_S)]
    return sorted(late, key=lambda row: row.created_at)[:1]


def _taken(session: Session, which: ColumnElement[bool], limit: int) -> Sequence[JobRow]:
    if limit <= 0:
        return []
    query = select(JobRow).where(JobRow.state == QUEUED, which)
    query = query.order_by(JobRow.priority, JobRow.turn, JobRow.id).limit(limit)
    return session.scalars(query.with_for_update(skip_locked=True)).all()


def _turn(session: Session, state: str, order: UnaryExpression[int], **like: object) -> int | None:
    """The first turn of the jobs in a state. Turns are between plants, so all of them count, whoever asks.

    Not by max() and min(): where PostgreSQL expects few rows it reads all there are for these.
    """
    query = select(JobRow.turn).filter_by(state=state, **like).order_by(order).limit(1)
    return session.scalar(query, execution_options=EVERY_PLANT)
