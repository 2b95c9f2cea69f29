"""Repository of shelvings, suppressions by design and removals from service."""

from collections.abc import Sequence

from sqlalchemy import or_, select
from sqlalchemy.orm import Session

from estimator.errors import Missing
from storage.clock import TOLERANCE, now
from storage.paging import Keys, ordered
from storage.tables import SuppressionRow


class SuppressionUnknown(Missing):
    """No suppression of that id."""

    subject = "suppression"


def add(
    session: Session,
    machine_id: str,
    *,
    kind: str,
    rule: str | None,
    element: str | None,
    until: int | None,
    by: str,
    comment: str,
) -> SuppressionRow:
    """Begin a suppression; `rule` and `element` None suppress all of the machine."""
    row = SuppressionRow(
        machine_id=machine_id,
        rule=rule,
        element=element,
        kind=kind,
        since=now(),
        until=until,
        by=by,
        comment=comment,
        ended_at=None,
        ended_by=None,
    )
    session.add(row)
    session.flush()
    return row


def get(session: Session, suppression_id: int) -> SuppressionRow:
    """Raises SuppressionUnknown."""
    row = session.get(SuppressionRow, suppression_id)
    if row is None:
        raise SuppressionUnknown(suppression_id)
    return row


def in_force(
    session: Session, machine_id: str, *, limit: int | None = None, after: Keys | None = None
) -> Sequence[SuppressionRow]:
    """Suppressions of a machine that have not ended, oldest first; after: the one before."""
    query = select(SuppressionRow).where(SuppressionRow.machine_id == machine_id, SuppressionRow.ended_at.is_(None))
    return session.scalars(ordered(query, (SuppressionRow.id,), after, descending=False).limit(limit)).all()


def of_alert(session: Session, machine_id: str, *, rule: str, element: str) -> Sequence[SuppressionRow]:
    """Suppressions in force that apply to alerts of this rule and element."""
    query = (
        select(SuppressionRow)
        .where(SuppressionRow.machine_id == machine_id, SuppressionRow.ended_at.is_(None))
        .where(or_(SuppressionRow.rule.is_(None), SuppressionRow.rule == rule))
        .where(or_(SuppressionRow.element.is_(None), SuppressionRow.element == element))
    )
    return session.scalars(query.order_by(SuppressionRow.id)).all()


def expired(session: Session, moment: int) -> Sequence[SuppressionRow]:
    """Suppressions whose time is over at a moment [ns] and that have not been ended yet.

    Over is also the time of one that has yet to begin, for the clock was set back: it would last longer than anybody wanted.
    """
    query = select(SuppressionRow).where(SuppressionRow.ended_at.is_(None), SuppressionRow.until.is_not(None))
    query = query.where(or_(SuppressionRow.until <= moment, SuppressionRow.since > moment + TOLERANCE))
    return session.scalars(query.order_by(SuppressionRow.until, SuppressionRow.id)).all()


def end(row: SuppressionRow, *, by: str) -> None:
    """It is over."""
    row.ended_at, row.ended_by = now(), by
