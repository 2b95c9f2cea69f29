"""Reminds receivers of persisting alerts which they would otherwise take for resolved."""

import asyncio
import logging
from collections.abc import Sequence

from sqlalchemy.exc import DBAPIError

from service.advice.site_texts import SiteTexts
from service.delivery.channel import FIRING, Channel, EventMessage, RemindingChannel
from service.delivery.channel_kind import Connections
from service.delivery.channels import channel_kind, is_channel, open_channel
from service.delivery.messages import message_of
from service.delivery.sending import within_deadline
from storage.alerts import alerts, deliveries
from storage.database.engine import Database
from storage.database.errors import is_database_wide
from storage.tables.alerting import SubscriptionRow

logger = logging.getLogger(__name__)

RESEND_S = 60.0
"""Time between reminders [s]: Alertmanager takes an alert for resolved after `resolve_timeout` (5 minutes) without news."""


async def remind(database: Database, connections: Connections) -> None:
    """Remind every receiver that needs it of all persisting alerts."""
    try:
        targets, messages = await asyncio.to_thread(_persisting_alerts, database, connections.texts)
    except DBAPIError as error:
        logger.error("lasting alerts cannot be read: %s", error.orig)
        return
    except Exception:
        logger.exception("unexpected error while lasting alerts are read")
        return
    # Concurrently: hanging receivers must not delay the others until alerts expire there.
    await asyncio.gather(*(_remind_one(row, open_channel(row, connections), messages) for row in targets))


def _persisting_alerts(database: Database, texts: SiteTexts) -> tuple[list[SubscriptionRow], list[EventMessage]]:
    """Return the receivers to remind, and the last event of each persisting alert."""
    with database.reading() as session:
        rows = [row for row in deliveries.list_subscriptions(session) if _is_reminded(row)]
        if not rows:
            return [], []
        found = []
        for alert in alerts.find(session, machine_id=None, only_open=True, limit=10_000):
            if alert.state not in FIRING:
                continue
            try:
                found.append(message_of(session, alerts.history(session, alert.id)[-1], texts))
            except MemoryError:
                raise
            except Exception as error:
                if is_database_wide(error):
                    raise
                logger.exception("nobody is reminded that alert %d lasts", alert.id)
        return rows, found


def _is_reminded(row: SubscriptionRow) -> bool:
    return row.state == deliveries.ACTIVE and is_channel(row.kind) and channel_kind(row.kind).reminded


async def _remind_one(row: SubscriptionRow, channel: Channel, messages: Sequence[EventMessage]) -> None:
    own = [one for one in messages if deliveries.covers_plant(row, one.plant)]
    if own and isinstance(channel, RemindingChannel):
        outcome = await within_deadline(channel.push(own))
        if outcome.result != "delivered":
            logger.warning(
                "reminders of lasting alerts cannot be sent to %s '%s': %s", row.kind, row.name, outcome.answer[:200]
            )
