"""Renders subscriptions and deliveries as answers of the API."""

from service.api.alerts import subscription_schemas as schemas
from service.api.conventions.values import time_or_none
from service.delivery.signing_secrets import SigningSecrets, describe_storage
from storage.alerts import deliveries
from storage.alerts.deliveries import PENDING
from storage.clock import to_datetime
from storage.tables.alerting import DeliveryRow, SubscriptionRow


def subscription(row: SubscriptionRow, secrets: SigningSecrets) -> schemas.SubscriptionOut:
    """Return a subscription as the API shows it."""
    return schemas.SubscriptionOut(
        id=row.id,
        kind=row.kind,
        name=row.name,
        target=row.target,
        state=row.state,
        reason=row.reason,
        secret_kept=describe_storage(row.secret),
        trouble=secrets.trouble(row),
        plants=deliveries.subscribed_plants(row),
        reports=row.reports,
        created_at=to_datetime(row.created_at),
    )


def delivery(row: DeliveryRow) -> schemas.DeliveryOut:
    """Return a delivery as the API shows it."""
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
