"""The form of an alert event for everybody: in the API, in streams and in deliveries."""

from datetime import datetime

from pydantic import BaseModel, Field

from service.alerts.lifecycle import Severity
from storage.clock import to_datetime
from storage.tables.alerting import AlertEventRow


class AlertEvent(BaseModel):
    """One transition of an alert, or a comment on it."""

    id: int = Field(description="grows over all alerts: the event's id in streams and deliveries")
    alert: int
    number: int = Field(description="of the event within its alert, from 1 without gaps")
    machine: str
    rule: str
    element: str
    at: datetime
    kind: str
    state_before: str
    state: str
    severity: str
    message: str
    by: str
    comment: str
    opened_at: datetime
    identification: int


def alert_event(row: AlertEventRow) -> AlertEvent:
    """Return the message of a stored event."""
    return AlertEvent(
        id=row.id,
        alert=row.alert_id,
        number=row.number,
        machine=row.machine_id,
        rule=row.rule,
        element=row.element,
        at=to_datetime(row.at),
        kind=row.kind,
        state_before=row.state_before,
        state=row.state,
        severity=Severity(row.severity).label,
        message=row.message,
        by=row.by,
        comment=row.comment,
        opened_at=to_datetime(row.opened_at),
        identification=row.identification_id,
    )
