"""Publishes alert events on the zenoh network, and answers queries with the last event of each open alert."""

import asyncio
import logging
import threading

import zenoh

from service.advice.alert_advice import alert_event
from service.advice.site_texts import SiteTexts
from service.alerts.event_message import AlertEvent
from service.delivery.channel import EventMessage
from service.delivery.channel_kind import ChannelKind, Connections
from service.delivery.plant_channel import PlantChannel
from service.replication.work_share import DELIVERY, Share, WholeShare
from storage.alerts import alerts
from storage.database.engine import Database
from storage.machines import machines
from storage.tables.alerting import SubscriptionRow

logger = logging.getLogger(__name__)

ENCODING = "application/json"
ALL_ALERTS = "rundown/v1/*/*/alerts/*"


def alert_key(plant: str, event: AlertEvent) -> str:
    """Return the key expression of an alert's events."""
    return f"rundown/v1/{plant}/{event.machine}/alerts/{event.alert}"


def _open(_row: SubscriptionRow, connections: Connections) -> PlantChannel:
    async def publish(message: EventMessage) -> str:
        # Nobody confirms it: readers that must not miss one query the last state, or the events over REST.
        key, body = alert_key(message.plant, message.event), message.event.model_dump_json().encode()
        try:
            await asyncio.to_thread(connections.session.put, key, body, encoding=ENCODING)
        except zenoh.ZError as error:
            raise ConnectionError(str(error)) from error
        return key

    return PlantChannel(publish)


ZENOH = ChannelKind(
    "zenoh",
    title={"en": "the plant's own network (zenoh)", "de": "das eigene Netz der Anlage (zenoh)"},
    description="the plant's own network, no target",
    address=None,
    open=_open,
)


class LastStates:
    """Answers to queries on the alerts' keys: the last event of each open alert."""

    def __init__(
        self, session: zenoh.Session, database: Database, share: Share | None = None, texts: SiteTexts | None = None
    ) -> None:
        self._share = share or WholeShare()
        self._texts = texts or SiteTexts()
        self._database = database
        self._lock = threading.Lock()
        self._queryable = session.declare_queryable(ALL_ALERTS, self._answer)

    def close(self) -> None:
        """Stop answering."""
        self._queryable.undeclare()

    def _answer(self, query: zenoh.Query) -> None:
        if not self._share.is_leader(DELIVERY):
            query.drop()
            return
        with query, self._lock, self._database.reading() as reading:
            plants = {row.id: row.plant for row in machines.list_all(reading)}
            for row in alerts.find(reading, machine_id=None, only_open=True, limit=10_000):
                try:
                    event = alert_event(alerts.last_event(reading, row.id), self._texts)
                except (ValueError, OverflowError):
                    logger.exception("the last event of alert %d cannot be published", row.id)
                    continue
                key = alert_key(plants[row.machine_id], event)
                if query.key_expr.intersects(zenoh.KeyExpr(key)):
                    query.reply(key, event.model_dump_json().encode(), encoding=ENCODING)
