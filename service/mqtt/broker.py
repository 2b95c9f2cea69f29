"""Connections to the broker, and the few things of the library that it does not offer itself.

Source: MQTT Version 5.0 (OASIS 2019), §3.1.2.11 (session expiry, receive maximum), §3.8.3.1 (retain handling).
"""

import asyncio
import logging
import ssl

import aiomqtt
from paho.mqtt.client import MQTT_CLEAN_START_FIRST_ONLY
from paho.mqtt.packettypes import PacketTypes
from paho.mqtt.properties import Properties
from paho.mqtt.subscribeoptions import SubscribeOptions

from service.configuration.mqtt_settings import MqttSettings

logger = logging.getLogger(__name__)

KEEP_ALIVE_S = 15
"""After one and a half times as long without a sign of life either side takes the other for gone [s]."""
SESSION_S = 7 * 86_400
"""Time for which the broker keeps what comes for a service that is away [s]."""
UNCONFIRMED = 100
"""Messages that the broker sends before the first of them is durable; the others wait there."""
LARGEST_PACKET = 2 << 20
"""Largest message that the broker may send [B]: of larger ones nothing arrives, and their samples are counted as missing."""
QUEUE_MESSAGES, QUEUE_BYTES = 10_000, 64 << 20
"""Limits of the messages of quality 0, which no broker holds back, that wait here; further ones are dropped and counted."""
TIMEOUT_S = 10.0

BrokerError = (aiomqtt.MqttError, OSError)
"""Errors of a broker that is away or refuses."""


class BoundedQueue(asyncio.Queue[aiomqtt.Message]):
    """The queue of incoming messages, which drops those of quality 0 beyond its limits."""

    def __init__(self, maxsize: int = 0) -> None:
        super().__init__(maxsize)
        self.bytes = 0
        self._dropped = 0

    def put_nowait(self, item: aiomqtt.Message) -> None:
        """Add a message, or drop it."""
        size = len(item.payload)
        if item.qos == 0 and (self.qsize() >= QUEUE_MESSAGES or self.bytes + size > QUEUE_BYTES):
            self._dropped += 1
            return
        self.bytes += size
        super().put_nowait(item)

    def take_dropped(self) -> int:
        """Return how many messages were dropped since the last time."""
        dropped, self._dropped = self._dropped, 0
        return dropped

    def _get(self) -> aiomqtt.Message:
        message: aiomqtt.Message = super()._get()
        self.bytes -= len(message.payload)
        return message


def new_client(settings: MqttSettings, name: str, *, lasting: bool, will: aiomqtt.Will | None = None) -> aiomqtt.Client:
    """Return a client that is not connected yet. lasting: the broker keeps its session, with what comes meanwhile.

    Raises OSError for certificates that cannot be read.
    """
    host, port = settings.mqtt_broker
    told = Properties(PacketTypes.CONNECT)  # type: ignore[no-untyped-call]
    told.ReceiveMaximum = UNCONFIRMED
    told.MaximumPacketSize = LARGEST_PACKET
    told.SessionExpiryInterval = SESSION_S if lasting else 0
    client = aiomqtt.Client(
        host,
        port,
        username=settings.mqtt_user or None,
        password=settings.mqtt_password.get_secret_value() or None,
        identifier=f"{settings.mqtt_client_id}-{name}",
        protocol=aiomqtt.ProtocolVersion.V5,
        clean_start=False if lasting else MQTT_CLEAN_START_FIRST_ONLY,
        properties=told,
        keepalive=KEEP_ALIVE_S,
        timeout=TIMEOUT_S,
        queue_type=BoundedQueue,
        tls_context=_trust(settings) if settings.mqtt_encrypted else None,
        will=will,
        logger=logger,
    )
    client.pending_calls_threshold = 10_000  # the library would warn of more than ten at once
    if lasting:
        client._client.manual_ack_set(True)
    return client


def forget(client: aiomqtt.Client) -> None:
    """Close the socket of a client whose connection failed: the library leaves it open after a refusal."""
    client._client._sock_close()


def only_new(qos: int) -> SubscribeOptions:
    """Return options of a subscription that receives retained messages once, not at every connection."""
    return SubscribeOptions(qos=qos, retainHandling=SubscribeOptions.RETAIN_SEND_IF_NEW_SUB)


def queue_of(client: aiomqtt.Client) -> BoundedQueue:
    """Return the queue of a client's incoming messages."""
    queue = client._queue
    assert isinstance(queue, BoundedQueue)
    return queue


def confirm(client: aiomqtt.Client, message: aiomqtt.Message) -> None:
    """Confirm a message to the broker, which then forgets it."""
    client._client.ack(message.mid, message.qos)


def encoding_of(message: aiomqtt.Message) -> str | None:
    """Return the content type that a message states; None without one."""
    return getattr(message.properties, "ContentType", None)


def _trust(settings: MqttSettings) -> ssl.SSLContext:
    context = ssl.create_default_context(cafile=settings.mqtt_tls_ca or None)
    if settings.mqtt_tls_certificate:
        context.load_cert_chain(settings.mqtt_tls_certificate, settings.mqtt_tls_key)
    return context
