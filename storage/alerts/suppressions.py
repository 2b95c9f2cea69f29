"""Repository of suppressions: shelved alerts, suppressions by design and machines removed from service."""

from collections.abc import Sequence

from sqlalchemy import func, or_, select
from sqlalchemy.orm import Session

from estimator.errors import Missing
from storage.clock import TOLERANCE, now
from storage.paging import Keys, ordered
from storage.tables.alerting import SuppressionRow


class SuppressionUnknown(Missing):
    """Raised when no suppression has this id."""

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
    until_cleared: bool = False,
) -> SuppressionRow:
    """Begin a suppression; `rule` and `element` None suppress all alerts of the machine."""
    row = SuppressionRow(
        machine_id=machine_id,
        rule=rule,
        element=element,
        kind=kind,
        since=now(),
        until=until,
        until_cleared=until_cleared,
        by=by,
        comment=comment,
        ended_at=None,
        ended_by=None,
    )
    session.add(row)
    session.flush()
    return row


def get(session: Session, suppression_id: int) -> SuppressionRow:
    """Return a suppression by id; raise SuppressionUnknown when there is none."""
    row = session.get(SuppressionRow, suppression_id)
    if row is None:
        raise SuppressionUnknown(suppression_id)
    return row


def in_force(
    session: Session, machine_id: str, *, limit: int | None = None, after: Keys | None = None
) -> Sequence[SuppressionRow]:
    """Return the suppressions of a machine that have not ended, oldest first. after: id of the last one of the page before."""
    query = select(SuppressionRow).where(SuppressionRow.machine_id == machine_id, SuppressionRow.ended_at.is_(None))
    return session.scalars(ordered(query, (SuppressionRow.id,), after, descending=False).limit(limit)).all()


def count_in_force(session: Session, machine_id: str) -> int:
    """Count the suppressions of a machine that have not ended."""
    query = select(func.count()).where(SuppressionRow.machine_id == machine_id, SuppressionRow.ended_at.is_(None))
    return session.scalar(query.select_from(SuppressionRow)) or 0


def of_alert(session: Session, machine_id: str, *, rule: str, element: str) -> Sequence[SuppressionRow]:
    """Return the suppressions in force that apply to alerts of this rule and element."""
    query = (
        select(SuppressionRow)
        .where(SuppressionRow.machine_id == machine_id, SuppressionRow.ended_at.is_(None))
        .where(or_(SuppressionRow.rule.is_(None), SuppressionRow.rule == rule))
        .where(or_(SuppressionRow.element.is_(None), SuppressionRow.element == element))
    )
    return session.scalars(query.order_by(SuppressionRow.id)).all()


def expired(session: Session, moment: int, *, limit: int) -> Sequence[SuppressionRow]:
    """Return some suppressions that have expired at a time [ns] but have not been ended yet.

    A suppression that begins in the future has expired too: the clock was set back since, and it would last longer than
    intended.
    """
    query = select(SuppressionRow).where(SuppressionRow.ended_at.is_(None), SuppressionRow.until.is_not(None))
    query = query.where(or_(SuppressionRow.until <= moment, SuppressionRow.since > moment + TOLERANCE))
    return session.scalars(query.order_by(SuppressionRow.until, SuppressionRow.id).limit(limit)).all()


def end(row: SuppressionRow, *, by: str) -> None:
    """End a suppression now."""
    row.ended_at, row.ended_by = now(), by
