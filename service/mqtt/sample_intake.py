"""Takes samples from the broker: each message is confirmed there once its samples are durable, so that nothing is lost between.

A message that comes again, after the broker or the service was away, is told by its numbers. Missing ones are counted as over
zenoh without a log.
"""

import asyncio
import logging
from concurrent.futures import Future
from dataclasses import dataclass

import aiomqtt

from service.configuration.mqtt_settings import MqttSettings
from service.journal.batch import StoreOutcome
from service.journal.http_queue import Busy, NotStoring, Publication, SubmissionSink
from service.mqtt.broker import UNCONFIRMED, confirm, encoding_of, new_client, only_new, queue_of
from service.mqtt.connection import MqttThread
from service.mqtt.topics import Topics
from service.replication.work_share import INGEST, Share
from service.wire import Key, Rejected, recognised

logger = logging.getLogger(__name__)

BUSY_S = 0.05
"""Pause before a message is offered again while nothing can be stored: the others wait at the broker."""
AGAIN_S = 1.0
TRIES = 3
"""Attempts for a message of a source of which nothing can be stored; then it is given up, and its samples count as missing."""
LEAVE_S = 2.0
"""Time for which a thread that stops waits for what is being stored."""
REFUSED = 0x80
"""Smallest reason code by which a broker refuses a subscription (MQTT 5.0, §3.9.3)."""
RETAINED = "a retained message is of unknown age: publish samples without the retain flag"


@dataclass(frozen=True)
class PublishedBody:
    """A body of samples as it was published, and how."""

    machine: str
    body: bytes
    encoding: str
    published: Publication


class SubscriptionRefused(aiomqtt.MqttError):
    """The broker does not let the service subscribe."""


class MqttSamples(MqttThread):
    """The thread that takes samples. Of several replicas the one that stores the first part of the machines does it for all."""

    def __init__(self, settings: MqttSettings, sink: SubmissionSink, share: Share) -> None:
        super().__init__("mqtt samples", settings, share, work=INGEST[0])
        self._sink = sink
        self._topics = Topics(settings.mqtt_topic_prefix)
        self._under_way: set[asyncio.Task[None]] = set()
        self._messages = self._given_up = self._dropped = 0

    @property
    def gauges(self) -> dict[str, float]:
        """Return figures for a monitoring system, by the name of the metric."""
        return {
            "rundown_mqtt_samples_connected": int(self.is_connected),
            "rundown_mqtt_messages": self._messages,
            "rundown_mqtt_messages_under_way": len(self._under_way),
            "rundown_mqtt_messages_given_up": self._given_up + self._dropped,
        }

    def new_client(self) -> aiomqtt.Client:
        """Return a client with a lasting session."""
        return new_client(self._settings, "samples", lasting=True)

    async def use(self, client: aiomqtt.Client) -> None:
        """Take messages one after the other; many are being stored at once."""
        self._under_way = set()
        slots = asyncio.Semaphore(UNCONFIRMED)
        await self._subscribe(client, self._topics.all_samples)
        self.begun()
        async for message in client.messages:
            await slots.acquire()
            self._messages += 1
            self._dropped += queue_of(client).take_dropped()
            one = self._body_of(message)
            promise = await self._offered(one)
            task = asyncio.create_task(self._settle(client, message, one, promise))
            self._under_way.add(task)
            task.add_done_callback(self._under_way.discard)
            task.add_done_callback(lambda _: slots.release())

    async def leave(self) -> None:
        """Wait for what is being stored, so that the broker need not send it again."""
        if self._under_way:
            await asyncio.wait(self._under_way, timeout=LEAVE_S)

    async def _subscribe(self, client: aiomqtt.Client, topic: str) -> None:
        """Subscribe to a filter. Raises SubscriptionRefused."""
        for code in await client.subscribe(topic, options=only_new(self._settings.mqtt_qos)):
            value = code if isinstance(code, int) else code.value
            if value >= REFUSED:
                raise SubscriptionRefused(f"it does not let '{self._settings.mqtt_user}' subscribe to {topic}: see its ACL")

    def _body_of(self, message: aiomqtt.Message) -> PublishedBody:
        """Return the body in a message, with what is wrong with it by its topic."""
        topic, body = str(message.topic), _bytes_of(message)
        key, fault = Key("", ""), None
        try:
            key = self._topics.machine_of(topic)
            if message.retain:
                raise Rejected("retained", RETAINED)
        except Rejected as rejected:
            fault = rejected
        encoding = encoding_of(message) or recognised(body)
        return PublishedBody(key.machine, body, encoding, Publication(f"mqtt {topic}", key.plant, fault))

    async def _offered(self, one: PublishedBody) -> Future[StoreOutcome]:
        """Offer a body until it is queued: the database may be away, or the queue full."""
        while True:
            try:
                return self._sink.offer(one.machine, one.body, one.encoding, one.published)
            except (Busy, NotStoring):
                await asyncio.sleep(BUSY_S)

    async def _settle(
        self, client: aiomqtt.Client, message: aiomqtt.Message, one: PublishedBody, promise: Future[StoreOutcome]
    ) -> None:
        """Confirm a message once its samples are durable, rejected and noted, or given up."""
        for attempt in range(TRIES):
            try:
                await asyncio.wrap_future(promise)
                break
            except Rejected:
                break
            except (Busy, NotStoring) as error:
                if attempt == TRIES - 1:
                    self._given_up += 1
                    logger.warning("%s is given up, its samples count as missing: %s", one.published.topic, error)
                    break
                await asyncio.sleep(AGAIN_S)
                promise = await self._offered(one)
            except Exception:
                self._given_up += 1
                logger.exception("%s cannot be taken", one.published.topic)
                break
        if message.qos:
            confirm(client, message)


def _bytes_of(message: aiomqtt.Message) -> bytes:
    payload = message.payload
    return payload if isinstance(payload, bytes) else b""
