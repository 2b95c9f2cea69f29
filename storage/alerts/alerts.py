"""Repository of alerts and of everything that ever happened to them."""

from collections.abc import Sequence
from typing import Any

from sqlalchemy import Row, func, select
from sqlalchemy.orm import Session

from estimator.errors import Missing
from storage.clock import now
from storage.paging import Keys, ordered
from storage.tables import AlertEventRow, AlertRow


class AlertUnknown(Missing):
    """No alert of that id."""

    subject = "alert"


def open_alert(session: Session, machine_id: str, *, rule: str, element: str) -> AlertRow | None:
    """The open alert of a machine, rule and element."""
    query = select(AlertRow).where(
        AlertRow.machine_id == machine_id,
        AlertRow.rule == rule,
        AlertRow.element == element,
        AlertRow.closed_at.is_(None),
    )
    return session.scalars(query.with_for_update()).one_or_none()


def open_alerts(session: Session, machine_id: str) -> Sequence[AlertRow]:
    """All open alerts of a machine."""
    query = select(AlertRow).where(AlertRow.machine_id == machine_id, AlertRow.closed_at.is_(None)).order_by(AlertRow.id)
    return session.scalars(query.with_for_update()).all()


def add(
    session: Session,
    machine_id: str,
    *,
    rule: str,
    element: str,
    message: str,
    evidence: dict[str, Any],
    identification_id: int,
    measured_at: int,
    latching: bool,
) -> AlertRow:
    """A new episode, still in the normal condition: its first event is yet to come."""
    moment = now()
    row = AlertRow(
        machine_id=machine_id,
        rule=rule,
        element=element,
        state="normal",
        condition="normal",
        severity=1,
        latching=latching,
        suppressions=[],
        event_count=0,
        message=message,
        evidence=evidence,
        identification_id=identification_id,
        measured_at=measured_at,
        first_measured_at=measured_at,
        opened_at=moment,
        updated_at=moment,
        closed_at=None,
    )
    session.add(row)
    session.flush()
    return row


def add_event(
    session: Session, row: AlertRow, *, kind: str, state_before: str, by: str, comment: str, at: int
) -> AlertEventRow:
    """Write down what has just happened to an alert, with the alert as it is now."""
    row.event_count += 1
    event = AlertEventRow(
        alert_id=row.id,
        number=row.event_count,
        machine_id=row.machine_id,
        rule=row.rule,
        element=row.element,
        at=at,
        kind=kind,
        state_before=state_before,
        state=row.state,
        severity=row.severity,
        message=row.message,
        by=by,
        comment=comment,
        opened_at=row.opened_at,
        identification_id=row.identification_id,
    )
    session.add(event)
    session.flush()
    return event


def get(session: Session, alert_id: int, *, to_change: bool = False) -> AlertRow:
    """Raises AlertUnknown."""
    row = session.get(AlertRow, alert_id, with_for_update=to_change or None)
    if row is None:
        raise AlertUnknown(alert_id)
    return row


ListedAlert = Row[Any]
"""The columns of an alert, under the same names: a long list of them is read much faster than the rows themselves."""


def find(
    session: Session, *, machine_id: str | None, only_open: bool, limit: int, after: Keys | None = None
) -> Sequence[ListedAlert]:
    """Alerts to read, newest first; after: time of opening and id of the one before the first."""
    # By the mapped attributes: the bare table's columns would slip past the conditions of a `PlantScope`.
    columns = (getattr(AlertRow, column.key) for column in AlertRow.__table__.columns)
    query = ordered(select(*columns), (AlertRow.opened_at, AlertRow.id), after)
    if machine_id is not None:
        query = query.where(AlertRow.machine_id == machine_id)
    if only_open:
        query = query.where(AlertRow.closed_at.is_(None))
    return session.execute(query.limit(limit)).all()


def history(
    session: Session, alert_id: int, *, limit: int | None = None, after: Keys | None = None
) -> Sequence[AlertEventRow]:
    """What happened to an alert, oldest first; after: number of the event before the first."""
    query = select(AlertEventRow).where(AlertEventRow.alert_id == alert_id)
    return session.scalars(ordered(query, (AlertEventRow.number,), after, descending=False).limit(limit)).all()


def last_event(session: Session, alert_id: int) -> AlertEventRow:
    """The newest of what happened to an alert: at least its opening."""
    newest = select(AlertEventRow).where(AlertEventRow.alert_id == alert_id).order_by(AlertEventRow.number.desc()).limit(1)
    return session.scalars(newest).one()


def events_after(session: Session, event_id: int, *, limit: int) -> Sequence[AlertEventRow]:
    """Events of all alerts behind a given one, oldest first."""
    query = select(AlertEventRow).where(AlertEventRow.id > event_id).order_by(AlertEventRow.id).limit(limit)
    return session.scalars(query).all()


def newest_event(session: Session) -> int:
    """Number of the newest event; 0 before the first."""
    return session.scalar(select(func.max(AlertEventRow.id))) or 0
