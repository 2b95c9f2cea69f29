"""Publishes alert events and trends on the broker, which keeps the last state of each for later listeners.

A broker that was killed may have lost what it kept: at each connection the last state of everything is told again, and what
waits to be delivered is due at once.
"""

import asyncio
import logging
from collections.abc import Sequence
from concurrent.futures import Future

import aiomqtt

from service.advice.site_texts import SiteTexts
from service.alerts.event_message import AlertEvent
from service.configuration.mqtt_settings import MqttSettings
from service.mqtt.broker import new_client
from service.mqtt.connection import MqttThread
from service.mqtt.stored_messages import KIND, RetainedMessage, StoredMessages
from service.mqtt.topics import Topics
from service.replication.work_share import DELIVERY, Share
from storage.alerts import deliveries
from storage.database.engine import Database

logger = logging.getLogger(__name__)

PATIENCE_S = 20.0
"""Time that an event waits for a broker that is away; then its delivery has failed, and is tried again."""
LOOK_S = 0.5
"""Interval at which new identifications are looked for."""
AT_ONCE = 50
"""Messages that are on their way at once."""


class BrokerUnavailable(ConnectionError):
    """The broker does not answer; the message says since when nothing can be published, and why."""


class MqttAlerts(MqttThread):
    """The thread that publishes. Of several replicas the one that delivers does it for all."""

    def __init__(self, settings: MqttSettings, database: Database, share: Share, texts: SiteTexts | None = None) -> None:
        super().__init__("mqtt alerts", settings, share, work=DELIVERY)
        self._database = database
        self._topics = Topics(settings.mqtt_topic_prefix)
        self._messages = StoredMessages(database, self._topics, texts or SiteTexts())
        self._loop: asyncio.AbstractEventLoop | None = None
        self._ready: aiomqtt.Client | None = None
        self._newest: dict[str, int] = {}  # number of the newest event by topic
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
        message = self._messages.of_event(plant, event)
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
        await self._publish_all(client, await asyncio.to_thread(self._messages.last_states, connecting=True))
        await client.publish(self._topics.status(self._settings.mqtt_client_id), b"online", qos=1, retain=True)
        self._ready = client
        self.note_connected()
        await asyncio.to_thread(_retry_deliveries, self._database)
        while True:
            await self._publish_all(client, await asyncio.to_thread(self._messages.due))
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


def _retry_deliveries(database: Database) -> None:
    """Make deliveries due that failed while the broker was away."""
    with database.transaction() as session:
        deliveries.retry_now(session, KIND)


async def _until_it_ends(client: aiomqtt.Client) -> None:
    """Wait until a connection breaks. Raises MqttError."""
    async for _ in client.messages:
        pass
