"""Chunks of waveforms from a zenoh topic."""

import threading
import time
from collections import deque
from collections.abc import Iterator
from types import TracebackType
from typing import Self

import zenoh

from service.edge.condition import Conditions
from service.edge.files import RATE_TOLERANCE
from service.edge.sample_window import Chunk
from service.edge.waveform_message import BadMessage, WaveformMessage, decode_waveforms
from storage.clock import is_ahead

QUEUE_BYTES = 64 << 20
"""Largest size of queued messages; further ones are dropped and counted."""
SILENCE_S = 5.0
"""Time without a message after which the topic counts as silent."""
PAUSE_S = 0.05
"""Pause between looks into an empty queue."""


class Topic:
    """A subscription to a topic of waveforms. sampling_rate: [Hz] configured, None accepts that of the messages."""

    def __init__(
        self,
        session: zenoh.Session,
        key: str,
        columns: list[str],
        conditions: Conditions,
        *,
        sampling_rate: float | None,
    ) -> None:
        self._columns = columns
        self._conditions = conditions
        self._sampling_rate = sampling_rate
        self._queue: deque[bytes] = deque()
        self._queued = 0
        self._left_out = 0
        self._lock = threading.Lock()
        self._key = key
        self._next: WaveformMessage | None = None
        self._subscriber: zenoh.Subscriber[None] | None = session.declare_subscriber(key, self._enqueue)

    def chunks(self, stop: threading.Event) -> Iterator[Chunk | None]:
        """Yield all that arrives until `stop`; None when nothing has arrived for a moment."""
        heard = time.monotonic()
        silent = False
        while True:
            stopping = stop.is_set()
            if stopping:
                self.close()
            payload, left_out = self._take()
            if left_out:
                self._conditions.add_event("input_overrun", None, f"{left_out} messages on {self._key} left out")
            if payload is None and stopping:
                return
            if payload is None:
                if not silent and time.monotonic() - heard > SILENCE_S:
                    silent = True
                    self._conditions.block([])
                    self._conditions.begin("no_waveforms", None, f"nothing on {self._key} for {SILENCE_S:g} s")
                yield None
                stop.wait(PAUSE_S)
                continue
            heard, silent = time.monotonic(), False
            chunk = self._chunk(payload)
            if chunk is not None:
                yield chunk

    def close(self) -> None:
        """Undeclare the subscription."""
        if self._subscriber is not None:
            self._subscriber.undeclare()
            self._subscriber = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def _enqueue(self, sample: zenoh.Sample) -> None:
        payload = sample.payload.to_bytes()
        with self._lock:
            if self._queued + len(payload) > QUEUE_BYTES:
                self._left_out += 1
                return
            self._queue.append(payload)
            self._queued += len(payload)

    def _take(self) -> tuple[bytes | None, int]:
        with self._lock:
            payload = self._queue.popleft() if self._queue else None
            self._queued -= 0 if payload is None else len(payload)
            left_out, self._left_out = self._left_out, 0
        return payload, left_out

    def _chunk(self, payload: bytes) -> Chunk | None:
        """Return the chunk in a message; None when the message is left out."""
        try:
            message = decode_waveforms(payload)
        except BadMessage as error:
            self._conditions.add_event("damaged_message", None, f"{self._key}: {error}")
            return None
        missing = [column for column in self._columns if column not in message.channels]
        if missing:
            detail = f"no {', '.join(missing)}; there are {', '.join(message.channels[:50])}"
            self._conditions.add_event("missing_column", None, f"{self._key}: {detail}")
            return None
        rate = message.sampling_rate
        if self._sampling_rate is not None and abs(rate / self._sampling_rate - 1.0) > RATE_TOLERANCE:
            detail = f"a message of {rate:g} Hz, {self._sampling_rate:g} Hz is configured"
            self._conditions.add_event("wrong_sampling_rate", None, f"{self._key}: {detail}")
            return None
        before, self._next = self._next, message
        if before is not None and message.time_ns <= before.time_ns and not is_ahead(before.time_ns):
            self._next = before
            self._conditions.add_event("time_reversed", None, f"{self._key}: sample {message.first} is not later than before")
            return None
        expected = None if before is None else before.first + before.values.shape[1]
        if expected is not None and message.first != expected:
            detail = f"{self._key}: sample {message.first} came where {expected} was due"
            self._conditions.add_event("input_gap", None, detail)
        values = message.values[[message.channels.index(column) for column in self._columns]]
        return Chunk(message.first, values, rate, anchor=message.first, anchor_ns=message.time_ns)
