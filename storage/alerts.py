"""Repository of alerts."""

from collections.abc import Sequence
from typing import Any

from sqlalchemy import select
from sqlalchemy.orm import Session

from storage.clock import now
from storage.tables import AlertRow

UNACKNOWLEDGED, RETURNED = "unacknowledged", "returned"


class AlertUnknown(KeyError):
    """No alert of that id."""


def open_alert(session: Session, machine_id: str, *, rule: str, element: str) -> AlertRow | None:
    """The open alert of a machine, rule and element."""
    query = select(AlertRow).where(
        AlertRow.machine_id == machine_id,
        AlertRow.rule == rule,
        AlertRow.element == element,
        AlertRow.closed_at.is_(None),
    )
    return session.scalars(query).one_or_none()


def raise_alert(
    session: Session,
    machine_id: str,
    *,
    rule: str,
    element: str,
    message: str,
    evidence: dict[str, Any],
    identification_id: int,
    measured_at: int,
) -> AlertRow:
    """Open an alert, or bring the open one up to date."""
    row = open_alert(session, machine_id, rule=rule, element=element)
    moment = now()
    if row is None:
        row = AlertRow(
            machine_id=machine_id,
            rule=rule,
            element=element,
            state=UNACKNOWLEDGED,
            message=message,
            evidence=evidence,
            identification_id=identification_id,
            measured_at=measured_at,
            opened_at=moment,
            updated_at=moment,
            closed_at=None,
        )
        session.add(row)
        session.flush()
        return row
    row.message, row.evidence, row.updated_at = message, evidence, moment
    row.identification_id, row.measured_at = identification_id, measured_at
    return row


def close_alert(row: AlertRow) -> None:
    """The statement no longer holds."""
    row.state, row.closed_at = RETURNED, now()
    row.updated_at = row.closed_at


def get(session: Session, alert_id: int) -> AlertRow:
    """Raises AlertUnknown."""
    row = session.get(AlertRow, alert_id)
    if row is None:
        raise AlertUnknown(alert_id)
    return row


def find(session: Session, *, machine_id: str | None, only_open: bool, limit: int) -> Sequence[AlertRow]:
    """Alerts, newest first."""
    query = select(AlertRow).order_by(AlertRow.opened_at.desc(), AlertRow.id.desc())
    if machine_id is not None:
        query = query.where(AlertRow.machine_id == machine_id)
    if only_open:
        query = query.where(AlertRow.closed_at.is_(None))
    return session.scalars(query.limit(limit)).all()
