"""An alert as OPC UA clients see it: its state, and the event that led to it."""

import logging
from dataclasses import dataclass

from sqlalchemy.orm import Session

from service.advice.advice import FAULTS_OF_CONTENT
from service.advice.alert_advice import event_text
from service.advice.site_texts import SiteTexts
from service.alerts.lifecycle import AlertStatus, Suppression
from service.alerts.transitions import status_of
from service.opcua.unshown import Unshown, alert_name
from storage.alerts import alerts, suppressions
from storage.machines import machines
from storage.tables.alerting import AlertEventRow, AlertRow

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class AlertReading:
    """An alert after one of its events. Times in ns since 1970; shelved_until: None unless it is shelved.

    shelved_once: whether the shelving ends before then when the cause is gone. has_text: False where what is stored of the
    event can be put into no words; the message then says so.
    """

    id: int
    plant: str
    machine: str
    rule: str
    element: str
    status: AlertStatus
    is_open: bool
    shelved_until: int | None
    shelved_once: bool
    identification: int
    event: int
    at: int
    kind: str
    message: str
    by: str
    comment: str
    has_text: bool

    @property
    def name(self) -> str:
        """Return the name of its condition: episodes of one rule and element of a machine have the same."""
        return f"{self.rule} {self.element}".strip()


@dataclass(frozen=True)
class AlertEvents:
    """Alerts of the events behind one, oldest first; last: the last of these events, many: how many there were."""

    readings: list[AlertReading]
    last: int
    many: int


def open_readings(session: Session, texts: SiteTexts, unshown: Unshown) -> list[AlertReading]:
    """Read every open alert, with its last event."""
    rows = alerts.all_open(session)
    found = (_readable(session, row.id, alerts.last_event(session, row.id), texts, unshown) for row in rows)
    return [one for one in found if one is not None]


def events_since(session: Session, event: int, texts: SiteTexts, unshown: Unshown, *, limit: int) -> AlertEvents:
    """Read the alerts of the events behind one; each with the standing that the alert has now."""
    events = alerts.events_after(session, event, limit=limit)
    found = (_readable(session, one.alert_id, one, texts, unshown) for one in events)
    last = events[-1].id if events else event
    return AlertEvents([one for one in found if one is not None], last, len(events))


def _readable(session: Session, alert: int, event: AlertEventRow, texts: SiteTexts, unshown: Unshown) -> AlertReading | None:
    """Return an alert after one of its events; None for what cannot be told, which must not hold up the others."""
    try:
        return _reading(session, alerts.get(session, alert), event, texts)
    except FAULTS_OF_CONTENT:
        logger.exception("event %d of alert %d is not told over OPC UA", event.id, alert)
        unshown.note(alert_name(alert))
        return None


def _reading(session: Session, row: AlertRow, event: AlertEventRow, texts: SiteTexts) -> AlertReading:
    status = status_of(row)
    until, once = None, False
    if Suppression.SHELVED in status.suppressions:
        matching = suppressions.of_alert(session, row.machine_id, rule=row.rule, element=row.element)
        shelvings = [one for one in matching if one.kind == Suppression.SHELVED]
        until = max((one.until for one in shelvings if one.until is not None), default=None)
        once = any(one.until_cleared for one in shelvings)
    said = event_text(event, texts)
    return AlertReading(
        id=row.id,
        plant=machines.get(session, row.machine_id).plant,
        machine=row.machine_id,
        rule=row.rule,
        element=row.element,
        status=status,
        is_open=row.closed_at is None,
        shelved_until=until,
        shelved_once=once,
        identification=row.identification_id,
        event=event.id,
        at=event.at,
        kind=event.kind,
        message=said.message,
        by=event.by,
        comment=said.comment,
        has_text=said.is_made,
    )
