"""Repository of alerts and of their events."""

from collections.abc import Sequence
from typing import Any

from sqlalchemy import Row, func, select
from sqlalchemy.orm import Session

from estimator.errors import Missing
from storage.clock import now
from storage.paging import Keys, ordered
from storage.tables.alerting import AlertEventRow, AlertRow


class AlertUnknown(Missing):
    """Raised when no alert has this id."""

    subject = "alert"


def open_alert(session: Session, machine_id: str, *, rule: str, element: str) -> AlertRow | None:
    """Return the open alert of a machine, rule and element, locked for changes; None when there is none."""
    query = select(AlertRow).where(
        AlertRow.machine_id == machine_id,
        AlertRow.rule == rule,
        AlertRow.element == element,
        AlertRow.closed_at.is_(None),
    )
    return session.scalars(query.with_for_update()).one_or_none()


def open_alerts(session: Session, machine_id: str) -> Sequence[AlertRow]:
    """Return all open alerts of a machine, locked for changes."""
    query = select(AlertRow).where(AlertRow.machine_id == machine_id, AlertRow.closed_at.is_(None)).order_by(AlertRow.id)
    return session.scalars(query.with_for_update()).all()


def all_open(session: Session) -> Sequence[AlertRow]:
    """Return the open alerts of all machines, oldest first."""
    return session.scalars(select(AlertRow).where(AlertRow.closed_at.is_(None)).order_by(AlertRow.id)).all()


def add(
    session: Session,
    machine_id: str,
    *,
    rule: str,
    element: str,
    evidence: dict[str, Any],
    identification_id: int,
    measured_at: int,
    latching: bool,
) -> AlertRow:
    """Add a new alert in the normal condition; its first event is still to be added."""
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
        message="",
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
    """Append an event to an alert, recording the alert's current state."""
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
        evidence=row.evidence,
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
    """Return an alert by id, locked when `to_change`; raise AlertUnknown when there is none."""
    row = session.get(AlertRow, alert_id, with_for_update=to_change or None)
    if row is None:
        raise AlertUnknown(alert_id)
    return row


ListedAlert = Row[Any]
"""The columns of an alert under the names of `AlertRow`: a long list of them is read much faster than mapped rows."""


def find(
    session: Session, *, machine_id: str | None, only_open: bool, limit: int, after: Keys | None = None
) -> Sequence[ListedAlert]:
    """Return alerts, newest first. after: (opening time, id) of the last alert of the page before."""
    # Use the mapped attributes: the table's own columns would bypass the conditions of a `PlantScope`.
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
    """Return the events of an alert, oldest first. after: number of the last event of the page before."""
    query = select(AlertEventRow).where(AlertEventRow.alert_id == alert_id)
    return session.scalars(ordered(query, (AlertEventRow.number,), after, descending=False).limit(limit)).all()


def last_event(session: Session, alert_id: int) -> AlertEventRow:
    """Return the newest event of an alert; every alert has at least its opening."""
    newest = select(AlertEventRow).where(AlertEventRow.alert_id == alert_id).order_by(AlertEventRow.number.desc()).limit(1)
    return session.scalars(newest).one()


def last_events(session: Session, *, limit: int) -> Sequence[AlertEventRow]:
    """Return the newest event of each machine, rule and element, newest first."""
    newest = select(func.max(AlertEventRow.id)).group_by(AlertEventRow.machine_id, AlertEventRow.rule, AlertEventRow.element)
    query = select(AlertEventRow).where(AlertEventRow.id.in_(newest)).order_by(AlertEventRow.id.desc()).limit(limit)
    return session.scalars(query).all()


def events_after(session: Session, event_id: int, *, limit: int) -> Sequence[AlertEventRow]:
    """Return the events of all alerts with a higher id than the given one, oldest first."""
    query = select(AlertEventRow).where(AlertEventRow.id > event_id).order_by(AlertEventRow.id).limit(limit)
    return session.scalars(query).all()


def newest_event(session: Session) -> int:
    """Return the id of the newest event; 0 when there is none."""
    return session.scalar(select(func.max(AlertEventRow.id))) or 0
