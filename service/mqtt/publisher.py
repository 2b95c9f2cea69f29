"""Publishes alert events and trends on the broker, which keeps the last state of each for later listeners.

A broker that was killed may have lost what it kept: at each connection the last state of everything is told again, and what
waits to be delivered is due at once.
"""

import asyncio
import logging
from collections.abc import Mapping, Sequence
from concurrent.futures import Future
from dataclasses import dataclass

import aiomqtt
from sqlalchemy.orm import Session

from service.advice.advice import FAULTS_OF_CONTENT
from service.advice.alert_advice import alert_event
from service.advice.site_texts import SiteTexts
from service.alerts.event_message import AlertEvent
from service.configuration.mqtt_settings import MqttSettings
from service.mqtt.broker import new_client
from service.mqtt.connection import MqttThread
from service.mqtt.topics import Topics
from service.mqtt.trend_message import trend_message
from service.replication.work_share import DELIVERY, Share
from storage.alerts import alerts, deliveries
from storage.database.engine import Database
from storage.findings import filed_estimates
from storage.findings.jobs import RUN
from storage.machines import machines
from storage.tables.alerting import AlertEventRow, SubscriptionRow
from storage.tables.findings import IdentificationRow

logger = logging.getLogger(__name__)

KIND = "mqtt"
"""Kind of the subscriptions that ask for it."""
PATIENCE_S = 20.0
"""Time that an event waits for a broker that is away; then its delivery has failed, and is tried again."""
LOOK_S = 0.5
"""Interval at which new identifications are looked for."""
AT_ONCE = 50
"""Identifications that are read at once, and messages that are on their way at once."""
LARGEST_LAST_STATES = 10_000
"""Most alerts whose last state is published at a connection, the newest first."""
OVERLAP = 50
"""Identifications before the last one that are looked at again: several replicas file at once."""

SubscriptionMarks = frozenset[tuple[int, tuple[str, ...] | None]]
"""Subscriptions by their ids, with the plants that each asks for; None for all."""


class BrokerUnavailable(ConnectionError):
    """The broker does not answer; the message says since when nothing can be published, and why."""


@dataclass(frozen=True)
class RetainedMessage:
    """A message that the broker keeps, or only passes on. number: number of the event; 0 for trends."""

    topic: str
    payload: bytes
    retain: bool = True
    number: int = 0


class MqttAlerts(MqttThread):
    """The thread that publishes. Of several replicas the one that delivers does it for all."""

    def __init__(self, settings: MqttSettings, database: Database, share: Share, texts: SiteTexts | None = None) -> None:
        super().__init__("mqtt alerts", settings, share, work=DELIVERY)
        self._database = database
        self._texts = texts or SiteTexts()
        self._topics = Topics(settings.mqtt_topic_prefix)
        self._loop: asyncio.AbstractEventLoop | None = None
        self._ready: aiomqtt.Client | None = None
        self._newest: dict[str, int] = {}  # number of the newest event by topic
        self._seen: dict[int, None] = {}  # identifications that were looked at, in order
        self._newest_measured: dict[str, int] = {}
        self._told: SubscriptionMarks = frozenset()  # for whom the last states were told
        self._published = 0

    @property
    def gauges(self) -> dict[str, float]:
        """Return figures for a monitoring system, by the name of the metric."""
        return {"rundown_mqtt_alerts_connected": int(self.is_connected), "rundown_mqtt_published": self._published}

    def new_client(self) -> aiomqtt.Client:
        """Return a client with a last will, by which the broker announces its end."""
        will = aiomqtt.Will(self._topics.status(self._settings.mqtt_client_id), b"offline", qos=1, retain=True)
        return new_client(self._settings, "alerts", lasting=False, will=will)

    async def publish_event(self, plant: str, event: AlertEvent) -> str:
        """Publish an event and return its topic, once the broker has it. For any event loop. Raises BrokerUnavailable."""
        ends = asyncio.get_running_loop().time() + PATIENCE_S
        while self._ready is None or self._loop is None:
            if asyncio.get_running_loop().time() > ends or self._stop.is_set():
                raise BrokerUnavailable(self.trouble or "the broker is away")
            await asyncio.sleep(0.02)
        message = self._message_of(plant, event)
        sending: Future[None] = asyncio.run_coroutine_threadsafe(self._publish(self._ready, message), self._loop)
        try:
            await asyncio.wrap_future(sending)
        except aiomqtt.MqttError as error:
            raise BrokerUnavailable(f"{self._settings.mqtt_url} cannot be used: {error}") from error
        return message.topic

    async def use(self, client: aiomqtt.Client) -> None:
        """Publish the last states, then new events until the connection ends."""
        self._loop = asyncio.get_running_loop()
        watching = asyncio.create_task(_until_it_ends(client))
        working = asyncio.create_task(self._work_with(client))
        try:
            await asyncio.wait([watching, working], return_when=asyncio.FIRST_COMPLETED)
        finally:
            self._ready = None
            for one in (watching, working):
                one.cancel()
        for one in (working, watching):
            if one.done() and not one.cancelled():
                one.result()

    async def complete_work(self) -> None:
        """Say that the service leaves."""
        client, self._ready = self._ready, None
        if client is not None:
            await client.publish(self._topics.status(self._settings.mqtt_client_id), b"offline", qos=1, retain=True)

    async def _work_with(self, client: aiomqtt.Client) -> None:
        await self._publish_all(client, await asyncio.to_thread(self._last_states, connecting=True))
        await client.publish(self._topics.status(self._settings.mqtt_client_id), b"online", qos=1, retain=True)
        self._ready = client
        self.note_connected()
        await asyncio.to_thread(_retry_deliveries, self._database)
        while True:
            await self._publish_all(client, await asyncio.to_thread(self._due_messages))
            await asyncio.sleep(LOOK_S)

    async def _publish_all(self, client: aiomqtt.Client, messages: Sequence[RetainedMessage]) -> None:
        for first in range(0, len(messages), AT_ONCE):
            await asyncio.gather(*(self._publish(client, one) for one in messages[first : first + AT_ONCE]))

    async def _publish(self, client: aiomqtt.Client, message: RetainedMessage) -> None:
        """Publish a message; one that is older than what the broker keeps is only passed on."""
        newest = message.number >= self._newest.get(message.topic, 0)
        if newest and message.retain and message.number:
            self._newest[message.topic] = message.number
        await client.publish(message.topic, message.payload, qos=self._settings.mqtt_qos, retain=message.retain and newest)
        self._published += 1

    def _message_of(self, plant: str, event: AlertEvent) -> RetainedMessage:
        topic = self._topics.alert(plant, event.machine, rule=event.rule, element=event.element)
        return RetainedMessage(topic, event.model_dump_json().encode(), retain=event.id > 0, number=event.id)

    def _last_states(self, *, connecting: bool = False) -> list[RetainedMessage]:
        """Return the last event of each alert and the newest identification of each machine, of plants with subscriptions.

        connecting: whether a connection begins: what was filed before is then no news.
        """
        with self._database.reading() as session:
            told = _subscribed(session)
            self._told = _marks(told)
            if connecting:
                self._seen |= _filed_lately(session)
            if not told:
                return []
            plants = {row.id: row.plant for row in machines.list_all(session) if _covers(told, row.plant)}
            rows = [one for one in alerts.last_events(session, limit=LARGEST_LAST_STATES) if one.machine_id in plants]
            last = (self._last_state(plants[one.machine_id], one) for one in rows)
            found = [one for one in last if one is not None]
            newest = filed_estimates.newest_of_each_machine(session)
            self._seen |= dict.fromkeys(one.id for one in newest)
            messages = self._trends_of(session, [one for one in newest if one.machine_id in plants], plants)
        return found + messages

    def _last_state(self, plant: str, row: AlertEventRow) -> RetainedMessage | None:
        """Return the message of an alert's last event; None for what cannot be told, which must not hold up the others."""
        try:
            return self._message_of(plant, alert_event(row, self._texts))
        except FAULTS_OF_CONTENT:
            logger.exception("the last event of alert %d cannot be published", row.alert_id)
            return None

    def _due_messages(self) -> list[RetainedMessage]:
        """Return the identifications since the last look, and all last states where subscriptions ask for them by now."""
        with self._database.reading() as session:
            asked = _marks(_subscribed(session))
        messages = self._new_trends()
        if asked - self._told:
            return messages + self._last_states()
        self._told = asked
        return messages

    def _new_trends(self) -> list[RetainedMessage]:
        """Return the identifications that were filed since the last look."""
        with self._database.reading() as session:
            after = max(self._seen, default=0) - OVERLAP
            filed = filed_estimates.filed(session, after=after, limit=2 * AT_ONCE, held_back_ns=0)
            rows = [row for row in filed if row.id not in self._seen]
            told = _subscribed(session) if rows else []
            plants = {row.id: row.plant for row in machines.list_all(session) if _covers(told, row.plant)} if told else {}
            messages = self._trends_of(session, [row for row in rows if row.machine_id in plants], plants)
        self._seen |= dict.fromkeys(row.id for row in rows)
        while len(self._seen) > 4 * OVERLAP:
            del self._seen[min(self._seen)]
        return messages

    def _trends_of(
        self, session: Session, rows: Sequence[IdentificationRow], plants: Mapping[str, str]
    ) -> list[RetainedMessage]:
        """Return the messages of identifications; the newest accepted one of single runs is kept by the broker."""
        found = []
        for row in rows:
            values = filed_estimates.values_of(session, [row.id])
            retain = row.scope == RUN and row.accepted and row.measured_at >= self._newest_measured.get(row.machine_id, 0)
            if retain:
                self._newest_measured[row.machine_id] = row.measured_at
            plant = plants[row.machine_id]
            found.append(
                RetainedMessage(self._topics.trends(plant, row.machine_id), trend_message(plant, row, values), retain)
            )
        return found


def _retry_deliveries(database: Database) -> None:
    """Make deliveries due that failed while the broker was away."""
    with database.transaction() as session:
        deliveries.retry_now(session, KIND)


def _filed_lately(session: Session) -> dict[int, None]:
    """Return the newest identification, and those before it that a look would find: others may still be filed among them."""
    newest = filed_estimates.newest_id(session)
    rows = filed_estimates.filed(session, after=newest - OVERLAP, limit=2 * AT_ONCE, held_back_ns=0)
    return dict.fromkeys([newest, *(one.id for one in rows)])


async def _until_it_ends(client: aiomqtt.Client) -> None:
    """Wait until a connection breaks. Raises MqttError."""
    async for _ in client.messages:
        pass


def _subscribed(session: Session) -> list[SubscriptionRow]:
    """Return the active subscriptions over MQTT."""
    return [row for row in deliveries.list_subscriptions(session) if row.kind == KIND and row.state == deliveries.ACTIVE]


def _marks(told: Sequence[SubscriptionRow]) -> SubscriptionMarks:
    """Return marks that differ as soon as other subscriptions, or other plants, are active."""
    plants = ((row.id, deliveries.subscribed_plants(row)) for row in told)
    return frozenset((number, None if some is None else tuple(sorted(some))) for number, some in plants)


def _covers(told: Sequence[SubscriptionRow], plant: str) -> bool:
    return any(deliveries.covers_plant(row, plant) for row in told)
