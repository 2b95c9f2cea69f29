"""Repository of baselines: the identifications, or the time from which on, that a machine is compared with."""

from collections.abc import Sequence

from sqlalchemy import select
from sqlalchemy.orm import Session

from storage.clock import now
from storage.paging import Keys, ordered
from storage.tables.machines import BaselineRow


def begin(
    session: Session, machine_id: str, *, since: int, identification_ids: list[int] | None, reason: str, by: str
) -> BaselineRow:
    """Add a baseline of the first identifications measured at `since` or later [ns], or of the named ones."""
    row = BaselineRow(
        machine_id=machine_id,
        since=since,
        identification_ids=identification_ids,
        reason=reason,
        by=by,
        created_at=now(),
    )
    session.add(row)
    session.flush()
    return row


def in_force(session: Session, machine_id: str, *, at: int) -> BaselineRow | None:
    """Return the baseline for measurements at a time [ns]; None before the first, when the machine's first runs are the
    baseline."""
    query = select(BaselineRow).where(BaselineRow.machine_id == machine_id, BaselineRow.since <= at)
    return session.scalars(query.order_by(BaselineRow.since.desc(), BaselineRow.id.desc()).limit(1)).one_or_none()


def in_force_at(session: Session, machine_id: str, times: Sequence[int]) -> list[BaselineRow | None]:
    """Return what `in_force` does for each of some times [ns], by one query."""
    query = select(BaselineRow).where(BaselineRow.machine_id == machine_id, BaselineRow.since <= max(times))
    newest_first = session.scalars(query.order_by(BaselineRow.since.desc(), BaselineRow.id.desc())).all()
    return [next((row for row in newest_first if row.since <= at), None) for at in times]


def of_machine(
    session: Session, machine_id: str, *, limit: int | None = None, after: Keys | None = None
) -> Sequence[BaselineRow]:
    """Return the baselines of a machine that a person or a maintenance began, newest first.

    after: (since, id) of the last one of the page before.
    """
    query = select(BaselineRow).where(BaselineRow.machine_id == machine_id)
    return session.scalars(ordered(query, (BaselineRow.since, BaselineRow.id), after).limit(limit)).all()
