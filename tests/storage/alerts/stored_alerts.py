"""Alerts and their events as the repositories store them, without the rules of the service."""

from sqlalchemy.orm import Session

from storage.alerts import alerts
from storage.tables.alerting import AlertEventRow, AlertRow
from tests.plant import KEY, START


def add(session: Session, identification_id: int, element: str, *, opened_at: int | None = None) -> AlertRow:
    """Add an alert of the plant's machine. opened_at: instead of now [ns]."""
    row = alerts.add(
        session,
        KEY.machine,
        rule="misalignment",
        element=element,
        evidence={"runs": 3},
        identification_id=identification_id,
        measured_at=START,
        latching=False,
    )
    if opened_at is not None:
        row.opened_at = opened_at
        session.flush()
    return row


def add_event(session: Session, row: AlertRow, kind: str = "raised", *, at: int = START) -> AlertEventRow:
    """Append an event to an alert."""
    return alerts.add_event(session, row, kind=kind, state_before="normal", by="anna", comment="", at=at)
