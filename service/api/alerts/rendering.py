"""Renders alerts and suppressions as answers of the API."""

from typing import Any

from service.alerts.lifecycle import Severity
from service.api.alerts import schemas
from service.api.conventions.values import time_or_none
from storage.alerts.alerts import ListedAlert
from storage.clock import to_datetime
from storage.tables.alerting import AlertRow, SuppressionRow


def alert(row: AlertRow) -> schemas.AlertOut:
    """Return an alert as the API shows it."""
    return schemas.AlertOut(**alert_fields(row))


def alert_fields(row: AlertRow | ListedAlert) -> dict[str, Any]:
    """Return the fields of `AlertOut`, for lists that are encoded without a model."""
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
        "message": row.message,
        "evidence": row.evidence,
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
        by=row.by,
        comment=row.comment,
        ended_at=time_or_none(row.ended_at),
        ended_by=row.ended_by,
    )
