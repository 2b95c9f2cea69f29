"""From zenoh to the ingest thread: messages are copied on arrival and wait here, limited in number and bytes.

A message kept in zenoh's own form holds its whole receive buffer, up to fifty times its size.
"""

import logging
from collections import deque
from dataclasses import dataclass

import zenoh

from formats.wire import LARGEST_MESSAGE
from service.resilience.supervised_thread import SupervisedThread
from storage.clock import now
from storage.measurements.quarantine import KEPT_BYTES

logger = logging.getLogger(__name__)

MAXIMUM_MESSAGES = 50_000
MAXIMUM_BYTES = 256 << 20
"""Limits of the waiting messages; beyond either zenoh makes the senders wait."""
CHANNEL_SIZE = 2_000
"""Messages that zenoh itself queues until they are copied."""
LOOK_S = 0.02
"""Pause between two looks for messages."""


@dataclass(frozen=True, slots=True)
class PublishedMessage:
    """A published message; of one above the size limit only the beginning. size: size of the whole message [bytes]."""

    key: str
    payload: bytes
    encoding: str
    size: int
    received_at: int

    @classmethod
    def of(cls, sample: zenoh.Sample) -> "PublishedMessage":
        """Return a copy of a zenoh sample, received now."""
        payload = sample.payload.to_bytes()
        kept = payload if len(payload) <= LARGEST_MESSAGE else payload[:KEPT_BYTES]
        return cls(str(sample.key_expr), kept, str(sample.encoding), len(payload), now())


class Inbox(SupervisedThread):
    """The thread that copies incoming messages, and the queue in which they wait for the ingest thread."""

    def __init__(self) -> None:
        super().__init__("inbox", failure="a message cannot be copied", retry_s=LOOK_S, first_pause_s=LOOK_S)
        self._waiting: deque[PublishedMessage] = deque()
        self._came_bytes = self._taken_bytes = 0  # each is changed by one thread only

    def open(self, session: zenoh.Session, key_expression: str) -> None:
        """Subscribe and start the thread."""
        self._subscriber = session.declare_subscriber(key_expression, zenoh.handlers.FifoChannel(CHANNEL_SIZE))
        self.start()

    def close(self) -> None:
        """Copy the messages that have come by now and none after; copied ones can still be taken."""
        if not self._stop.is_set():
            self.stop()
            self._subscriber.undeclare()

    @property
    def size(self) -> int:
        """Return the size of all waiting messages [bytes]."""
        return self._came_bytes - self._taken_bytes

    def __len__(self) -> int:
        """Return how many messages wait."""
        return len(self._waiting)

    def take(self) -> PublishedMessage | None:
        """Return the oldest waiting message; None when there is none."""
        if not self._waiting:
            return None
        message = self._waiting.popleft()
        self._taken_bytes += len(message.payload)
        return message

    def put_back(self, message: PublishedMessage) -> None:
        """Put back a message that cannot be processed now, as the oldest."""
        self._taken_bytes -= len(message.payload)
        self._waiting.appendleft(message)

    def run_once(self) -> float:
        """Copy the messages that have come."""
        self._copy()
        return LOOK_S

    def finish(self) -> None:
        """Copy the messages that have come by now."""
        self._copy()

    def failed(self, error: Exception) -> float:
        """Log the error and go on: one message must never end the ingest of all others."""
        logger.error("a message cannot be copied from zenoh and is dropped", exc_info=error)
        return LOOK_S

    def _copy(self) -> None:
        while self._has_room and (sample := self._subscriber.try_recv()) is not None:
            message = PublishedMessage.of(sample)
            self._came_bytes += len(message.payload)
            self._waiting.append(message)

    @property
    def _has_room(self) -> bool:
        return len(self._waiting) < MAXIMUM_MESSAGES and self.size < MAXIMUM_BYTES
