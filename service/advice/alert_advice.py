"""Alerts and their events as they are sent out: message and advice, made from the stored numbers."""

import logging
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from service.advice.advice import FAULTS_OF_CONTENT, FindingFacts, advice_of, plain_message
from service.advice.site_texts import SiteTexts
from service.alerts.advice_message import Advice
from service.alerts.event_message import AlertEvent
from service.alerts.lifecycle import CAUSE_GONE, Severity
from service.alerts.transitions import SERVICE
from service.wording.stored_sentences import comment_in_language
from storage.alerts.alerts import ListedAlert
from storage.clock import to_datetime
from storage.tables.alerting import AlertEventRow, AlertRow

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class EventText:
    """The words of a stored event. is_made: False where no text takes what is stored; the message then says so."""

    message: str
    advice: Advice | None
    comment: str
    is_made: bool = True


def alert_advice(row: AlertRow | ListedAlert, texts: SiteTexts) -> Advice | None:
    """Return the advice on an alert; None where an older release has stored too few numbers."""
    evidence = row.evidence or {}
    return advice_of(_facts(row, evidence, to_datetime(row.measured_at)), texts)


def alert_message(row: AlertRow | AlertEventRow | ListedAlert, advice: Advice | None, texts: SiteTexts) -> str:
    """Return an alert in one sentence: of its advice, else what an older release has stored."""
    if advice is not None:
        return advice.what
    return row.message or plain_message(row.rule, row.element, texts.language)


def event_text(row: AlertEventRow, texts: SiteTexts) -> EventText:
    """Return what is said of a stored event: whatever its evidence is, its alert must not be hidden by it."""
    try:
        advice = None if row.evidence is None else advice_of(_facts(row, row.evidence, _measured(row)), texts)
        comment = comment_in_language(row.comment, texts.language) if row.by == SERVICE else row.comment
        return EventText(alert_message(row, advice, texts), advice, comment)
    except FAULTS_OF_CONTENT:
        logger.exception("the text of event %d of alert %d cannot be made", row.id, row.alert_id)
        what = plain_message(row.rule, row.element, texts.language)
        return EventText(texts.language.translate("no_text", what=what), None, row.comment, is_made=False)


def alert_event(row: AlertEventRow, texts: SiteTexts) -> AlertEvent:
    """Return the message of a stored event. Raises ValueError, OverflowError where its severity or its times are none."""
    said = event_text(row, texts)
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
        message=said.message,
        advice=said.advice,
        by=row.by,
        comment=said.comment,
        opened_at=to_datetime(row.opened_at),
        identification=row.identification_id,
    )


def _facts(row: AlertRow | AlertEventRow | ListedAlert, evidence: dict[str, Any], moment: datetime) -> FindingFacts:
    return FindingFacts(
        machine=row.machine_id,
        kind=str(evidence.get("kind", row.rule)),
        element=row.element,
        evidence=evidence,
        severity=Severity(row.severity),
        measured_at=moment,
        is_gone=row.state in CAUSE_GONE,
    )


def _measured(row: AlertEventRow) -> datetime:
    """Return when the run was measured that showed the finding last; the event's own time where that is not stored."""
    said = (row.evidence or {}).get("measured_at")
    return to_datetime(row.at) if said is None else datetime.fromisoformat(said)
