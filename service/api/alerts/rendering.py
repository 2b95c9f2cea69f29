"""Renders alerts and suppressions as answers of the API."""

from typing import Any

from service.advice.alert_advice import alert_advice, alert_message
from service.advice.site_texts import SiteTexts
from service.alerts.advice_message import Advice
from service.alerts.lifecycle import Severity
from service.api.alerts import schemas
from service.api.conventions.values import time_or_none
from service.api.findings.evidence import with_moved_in_per_cent
from storage.alerts.alerts import ListedAlert
from storage.clock import to_datetime
from storage.tables.alerting import AlertRow, SuppressionRow


def alert(row: AlertRow, texts: SiteTexts) -> schemas.AlertOut:
    """Return an alert as the API shows it."""
    return schemas.AlertOut(**_fields(row, alert_advice(row, texts), texts))


def alert_json(row: ListedAlert, texts: SiteTexts) -> dict[str, Any]:
    """Return the fields of `AlertOut` as JSON has them, for lists that are encoded without a model."""
    advice = alert_advice(row, texts)
    return _fields(row, advice, texts) | {"advice": None if advice is None else advice.model_dump()}


def _fields(row: AlertRow | ListedAlert, advice: Advice | None, texts: SiteTexts) -> dict[str, Any]:
    return {
        "id": row.id,
        "machine": row.machine_id,
        "rule": row.rule,
        "element": row.element,
        "state": row.state,
        "condition": row.condition,
        "severity": Severity(row.severity).label,
        "latching": row.latching,
        "suppressions": row.suppressions,
        "message": alert_message(row, advice, texts),
        "advice": advice,
        "evidence": with_moved_in_per_cent(row.evidence, {}) if "moved" in row.evidence else row.evidence,
        "identification": row.identification_id,
        "measured_at": to_datetime(row.measured_at),
        "first_measured_at": to_datetime(row.first_measured_at),
        "opened_at": to_datetime(row.opened_at),
        "updated_at": to_datetime(row.updated_at),
        "closed_at": time_or_none(row.closed_at),
        "events": row.event_count,
    }


def suppression(row: SuppressionRow) -> schemas.SuppressionOut:
    """Return a suppression as the API shows it."""
    return schemas.SuppressionOut(
        id=row.id,
        machine=row.machine_id,
        kind=row.kind,
        rule=row.rule,
        element=row.element,
        since=to_datetime(row.since),
        until=time_or_none(row.until),
        until_cleared=row.until_cleared,
        by=row.by,
        comment=row.comment,
        ended_at=time_or_none(row.ended_at),
        ended_by=row.ended_by,
    )
