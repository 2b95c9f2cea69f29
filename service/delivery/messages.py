"""Messages of stored alert events, and the test message of a subscription."""

from sqlalchemy.orm import Session

from service.advice.alert_advice import alert_event
from service.advice.site_texts import SiteTexts
from service.alerts import transitions
from service.alerts.event_message import AlertEvent
from service.alerts.lifecycle import Severity
from service.delivery.channel import EventMessage
from service.wording.language import ENGLISH, Language
from storage.clock import now, to_datetime
from storage.machines import machines
from storage.tables.alerting import AlertEventRow


def message_of(session: Session, event: AlertEventRow, texts: SiteTexts) -> EventMessage:
    """Return the message of an event."""
    return EventMessage(alert_event(event, texts), machines.get(session, event.machine_id).plant)


def trial_message(language: Language = ENGLISH) -> EventMessage:
    """Return a test message."""
    moment = to_datetime(now())
    event = AlertEvent(
        id=0,
        alert=0,
        number=1,
        machine="test",
        rule="test",
        element="test",
        at=moment,
        kind="test",
        state_before="normal",
        state="normal",
        severity=Severity.ALERT.label,
        message=language.translate("mail.test"),
        by=transitions.SERVICE,
        comment="",
        opened_at=moment,
        identification=0,
    )
    return EventMessage(event, "test")
