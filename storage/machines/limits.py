"""Repository of the limits that people set for machines: immutable versions, of which the newest is in force."""

from collections.abc import Sequence
from typing import Any

from sqlalchemy import select
from sqlalchemy.orm import Session

from storage.clock import now
from storage.paging import Keys, ordered
from storage.tables.machines import LimitsRow


def add(session: Session, machine_id: str, *, document: dict[str, Any], by: str, comment: str) -> LimitsRow:
    """Store limits as a machine's next version, the first being 1."""
    newest = in_force(session, machine_id)
    version = 1 if newest is None else newest.version + 1
    row = LimitsRow(machine_id=machine_id, version=version, document=document, at=now(), by=by, comment=comment)
    session.add(row)
    session.flush()
    return row


def in_force(session: Session, machine_id: str) -> LimitsRow | None:
    """Return the newest version; None while nobody has set any."""
    return next(iter(versions(session, machine_id, limit=1)), None)


def versions(session: Session, machine_id: str, *, limit: int, after: Keys | None = None) -> Sequence[LimitsRow]:
    """Return the versions, newest first. after: the last version of the page before."""
    query = ordered(select(LimitsRow).where(LimitsRow.machine_id == machine_id), (LimitsRow.version,), after)
    return session.scalars(query.limit(limit)).all()
