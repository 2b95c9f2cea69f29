"""From rows about alerts to answers of the API."""

from typing import Any

from service.alert_life import Severity
from service.api import alert_schemas as schemas
from service.api.rendering import time_or_none
from service.delivery.signing_secrets import SigningSecrets, where_kept
from storage import deliveries
from storage.alerts import ListedAlert
from storage.clock import to_datetime
from storage.deliveries import PENDING
from storage.tables import AlertRow, BaselineRow, DeliveryRow, SubscriptionRow, SuppressionRow, TimelineRow


def alert(row: AlertRow) -> schemas.AlertOut:
    return schemas.AlertOut(**alert_fields(row))


def alert_fields(row: AlertRow | ListedAlert) -> dict[str, Any]:
    """Of `AlertOut`, for lists that are encoded without a model."""
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


def timeline_entry(row: TimelineRow) -> schemas.TimelineOut:
    return schemas.TimelineOut(
        id=row.id,
        machine=row.machine_id,
        at=to_datetime(row.at),
        kind=row.kind,
        text=row.text,
        by=row.by,
        created_at=to_datetime(row.created_at),
    )


def baseline(row: BaselineRow) -> schemas.BaselineOut:
    return schemas.BaselineOut(
        id=row.id,
        machine=row.machine_id,
        since=to_datetime(row.since),
        identifications=row.identification_ids,
        reason=row.reason,
        by=row.by,
        created_at=to_datetime(row.created_at),
    )


def subscription(row: SubscriptionRow, secrets: SigningSecrets) -> schemas.SubscriptionOut:
    return schemas.SubscriptionOut(
        id=row.id,
        kind=row.kind,
        name=row.name,
        target=row.target,
        state=row.state,
        reason=row.reason,
        secret_kept=where_kept(row.secret),
        trouble=secrets.trouble(row),
        plants=deliveries.told_of(row),
        created_at=to_datetime(row.created_at),
    )


def delivery(row: DeliveryRow) -> schemas.DeliveryOut:
    return schemas.DeliveryOut(
        id=row.id,
        subscription=row.subscription_id,
        event=row.event_id,
        alert=row.alert_id,
        state=row.state,
        attempts=row.attempts,
        next_try_at=to_datetime(row.next_try_at) if row.state == PENDING else None,
        last_try_at=time_or_none(row.last_try_at),
        answer=row.answer,
    )
