"""Takes samples from the broker: a message is confirmed there once its samples are durable, so that none is lost between.

A message that is sent again, after the broker or the service was away, is recognised by its sequence numbers. Missing
ones are counted as over zenoh without a log.
"""

import asyncio
import logging
import time
from collections.abc import Sequence
from concurrent.futures import Future
from contextlib import suppress
from dataclasses import dataclass

import aiomqtt

from formats.wire import MESSAGEPACK, Key, Rejected, encode_body, recognised
from service.configuration.mqtt_settings import MqttSettings
from service.mqtt.broker import UNCONFIRMED, confirm, encoding_of, new_client, only_new, queue_of
from service.mqtt.connection import MqttThread
from service.mqtt.mapped_machines import MappedMachines
from service.mqtt.sparkplug_nodes import NAMESPACE, SparkplugNodes
from service.mqtt.topics import Topics
from service.replication.work_share import INGEST, Share
from service.write_path.batch import StoreOutcome
from service.write_path.http_queue import Busy, NotStoring, Publication, SubmissionSink
from storage.database.engine import Database
from storage.database.errors import is_database_wide

logger = logging.getLogger(__name__)

BUSY_S = 0.05
"""Pause before a message is offered again while nothing can be stored: the others wait at the broker."""
AGAIN_S = 1.0
REBIRTH_LOOK_S = 0.2
TRIES = 3
"""Attempts for a message of a source of which nothing can be stored; then it is given up, and its samples count as missing."""
LEAVE_S = 2.0
"""Time for which a thread that stops waits for what is being stored."""
DOCUMENTS_S = 5.0
"""Interval at which machines' documents are looked at for what comes as Sparkplug B."""
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
    """The thread that takes samples.

    Of several replicas the one that stores the first part of the machines does it for all.
    """

    def __init__(self, settings: MqttSettings, database: Database, sink: SubmissionSink, share: Share) -> None:
        super().__init__("mqtt samples", settings, share, work=INGEST[0])
        self._sink = sink
        self._mapped = MappedMachines(database)
        self._nodes = SparkplugNodes(time.time_ns())
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
            "rundown_sparkplug_messages_missing": self._nodes.missing,
        }

    def new_client(self) -> aiomqtt.Client:
        """Return a client with a lasting session."""
        return new_client(self._settings, "samples", lasting=True)

    async def use(self, client: aiomqtt.Client) -> None:
        """Take messages one after the other; many are being stored at once."""
        self._under_way = set()
        await self._subscribe(client, [self._topics.all_samples])
        self.note_connected()
        taking = asyncio.create_task(self._take_all(client))
        following = asyncio.create_task(self._follow_documents(client))
        try:
            await asyncio.wait([taking, following], return_when=asyncio.FIRST_COMPLETED)
        finally:
            for one in (taking, following):
                one.cancel()
        for one in (taking, following):
            if one.done() and not one.cancelled():
                one.result()

    async def _take_all(self, client: aiomqtt.Client) -> None:
        slots = asyncio.Semaphore(UNCONFIRMED)
        async for message in client.messages:
            await slots.acquire()
            self._messages += 1
            self._dropped += queue_of(client).take_dropped()
            offered = [(one, await self._offered(one)) for one in self._readable_bodies(message)]
            task = asyncio.create_task(self._settle(client, message, offered))
            self._under_way.add(task)
            task.add_done_callback(self._under_way.discard)
            task.add_done_callback(lambda _: slots.release())

    async def _follow_documents(self, client: aiomqtt.Client) -> None:
        """Subscribe to the Sparkplug nodes that documents name, as these change, and ask nodes for their names."""
        subscribed: set[str] = set()
        looked = -DOCUMENTS_S
        while True:
            if time.monotonic() >= looked + DOCUMENTS_S:
                looked = time.monotonic()
                try:
                    self._nodes.follow(await asyncio.to_thread(self._mapped.read))
                except Exception as error:
                    if not is_database_wide(error):
                        logger.exception("documents cannot be read for Sparkplug")
                if new := set(self._nodes.filters) - subscribed:
                    await self._subscribe(client, sorted(new))
                    subscribed |= new
            for topic, payload in self._nodes.rebirths():
                await client.publish(topic, payload, qos=0)
            await asyncio.sleep(REBIRTH_LOOK_S)

    async def complete_work(self) -> None:
        """Wait for what is being stored, so that the broker need not send it again."""
        if self._under_way:
            await asyncio.wait(self._under_way, timeout=LEAVE_S)

    async def _subscribe(self, client: aiomqtt.Client, topics: Sequence[str]) -> None:
        """Subscribe to filters. Raises SubscriptionRefused."""
        for topic in topics:
            for code in await client.subscribe(topic, options=only_new(self._settings.mqtt_qos)):
                if (code if isinstance(code, int) else code.value) >= REFUSED:
                    who = self._settings.mqtt_user or "anonymous"
                    raise SubscriptionRefused(f"it does not let '{who}' subscribe to {topic}: see its rules of access")

    def _readable_bodies(self, message: aiomqtt.Message) -> list[PublishedBody]:
        """Return the bodies in a message; none where reading it fails, for it would fail again whenever it came again."""
        try:
            return self._bodies_of(message)
        except Exception:
            logger.exception("mqtt %s cannot be read; it is given up", message.topic)
            self._given_up += 1
            return []

    def _bodies_of(self, message: aiomqtt.Message) -> list[PublishedBody]:
        """Return the bodies in a message, with what is wrong with them by their topic."""
        topic, body = str(message.topic), _bytes_of(message)
        if topic.startswith(f"{NAMESPACE}/"):
            return self._from_sparkplug(topic, body, is_retained=message.retain)
        key, fault = Key("", ""), None
        try:
            key = self._topics.machine_of(topic)
            if message.retain:
                raise Rejected("retained", RETAINED)
        except Rejected as rejected:
            fault = rejected
        encoding = encoding_of(message) or recognised(body)
        return [PublishedBody(key.machine, body, encoding, Publication(f"mqtt {topic}", key.plant, fault))]

    def _from_sparkplug(self, topic: str, body: bytes, *, is_retained: bool) -> list[PublishedBody]:
        """Return a sample for each machine that a Sparkplug message has values of; where it is wrong, its refusal for each."""
        where = f"mqtt {topic}"
        try:
            if is_retained:
                raise Rejected("retained", RETAINED)
            return [
                PublishedBody(one.machine, encode_body(one), MESSAGEPACK, Publication(where, one.plant))
                for one in self._nodes.batches(topic, body)
            ]
        except Rejected as fault:
            fed = self._nodes.machines_of(topic)
            return [PublishedBody(one.id, body, "", Publication(where, one.plant, fault)) for one in fed]

    async def _offered(self, one: PublishedBody) -> Future[StoreOutcome]:
        """Submit a body until it is queued: the database may be away, or the queue full."""
        while True:
            try:
                return self._sink.offer(one.machine, one.body, one.encoding, one.published)
            except (Busy, NotStoring):
                await asyncio.sleep(BUSY_S)

    async def _settle(
        self, client: aiomqtt.Client, message: aiomqtt.Message, offered: Sequence[tuple[PublishedBody, Future[StoreOutcome]]]
    ) -> None:
        """Confirm a message once its samples are durable, rejected and noted, or given up."""
        for one, promise in offered:
            await self._stored(one, promise)
        if message.qos:
            confirm(client, message)

    async def _stored(self, one: PublishedBody, promise: Future[StoreOutcome]) -> None:
        """Wait until a body is stored or rejected; offer it again, at most TRIES times."""
        with suppress(Rejected):
            for _ in range(TRIES):
                try:
                    await asyncio.wrap_future(promise)
                    return
                except (Busy, NotStoring) as error:
                    reason: Exception = error
                except Rejected:
                    raise
                except Exception as error:
                    logger.exception("%s cannot be taken", one.published.topic)
                    reason = error
                await asyncio.sleep(AGAIN_S)
                promise = await self._offered(one)
            self._given_up += 1
            logger.warning("%s is given up, its samples count as missing: %s", one.published.topic, reason)


def _bytes_of(message: aiomqtt.Message) -> bytes:
    payload = message.payload
    return payload if isinstance(payload, bytes) else b""
