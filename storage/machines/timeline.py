"""Repository of notes and markers on machines' timelines."""

from collections.abc import Sequence

from sqlalchemy import select
from sqlalchemy.orm import Session

from storage.clock import now
from storage.paging import Keys, between, ordered
from storage.tables.machines import TimelineRow


def add(session: Session, machine_id: str, *, at: int, kind: str, text: str, by: str) -> TimelineRow:
    """Add an entry to a machine's timeline at a time [ns]."""
    row = TimelineRow(machine_id=machine_id, at=at, kind=kind, text=text, by=by, created_at=now())
    session.add(row)
    session.flush()
    return row


def of_machine(
    session: Session,
    machine_id: str,
    *,
    first: int | None = None,
    last: int | None = None,
    limit: int,
    after: Keys | None = None,
) -> Sequence[TimelineRow]:
    """Return the entries between two times [ns], newest first. after: (time, id) of the last one of the page before."""
    query = select(TimelineRow).where(TimelineRow.machine_id == machine_id)
    query = between(query, TimelineRow.at, first, last)
    return session.scalars(ordered(query, (TimelineRow.at, TimelineRow.id), after).limit(limit)).all()
