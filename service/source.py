"""A source of samples, as any edge device would be one: numbers its samples, keeps a log and answers replay queries.

Publishing never blocks and may lose messages on the way (congestion, a service that restarts); the log is what makes the
store complete. Sources without a log work too: what they lose is counted, not healed.
"""

import threading
import time
from collections import deque
from types import TracebackType
from typing import Self

import zenoh

from service.wire import MESSAGEPACK, Key, SampleBatch, encode_batch

LOG_SAMPLES = 200_000
"""Samples kept for replay."""
LARGEST_REPLY_COUNT = 2_000
"""Batches sent in answer to one query; the asker comes back for more."""


class Source:
    """One start of one source of one machine."""

    def __init__(self, session: zenoh.Session, key: Key, *, name: str, encoding: str = MESSAGEPACK) -> None:
        self.key = key
        self.name = name
        self.epoch = time.time_ns()
        self._session = session
        self._encoding = encoding
        self._sequence = 0
        self._log: deque[tuple[int, int, bytes]] = deque()  # first sequence, samples, payload
        self._logged = 0
        self._lock = threading.Lock()
        self._publisher = session.declare_publisher(
            key.samples, encoding=encoding, congestion_control=zenoh.CongestionControl.DROP
        )
        self._queryable = session.declare_queryable(key.log, self._answer)
        self._token = session.liveliness().declare_token(key.live)

    @property
    def sequence(self) -> int:
        """Number of the next sample."""
        return self._sequence

    def publish(self, batch: SampleBatch) -> None:
        """Number a batch, log it and send it."""
        batch.source, batch.epoch, batch.sequence = self.name, self.epoch, self._sequence
        payload = encode_batch(batch, self._encoding)
        with self._lock:
            self._log.append((self._sequence, len(batch.time_ns), payload))
            self._logged += len(batch.time_ns)
            while self._logged > LOG_SAMPLES:
                self._logged -= self._log.popleft()[1]
        self._sequence += len(batch.time_ns)
        self._publisher.put(payload)

    def close(self) -> None:
        """Leave the network."""
        self._token.undeclare()
        self._queryable.undeclare()
        self._publisher.undeclare()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def _answer(self, query: zenoh.Query) -> None:
        """Replies to `…/log?from=N;epoch=E;limit=L` with the batches that hold sample N and later ones."""
        parameters = query.parameters
        epoch = parameters.get("epoch")
        with query:
            if epoch is not None and epoch != str(self.epoch):
                return
            first = _whole(parameters.get("from"), 0)
            limit = min(_whole(parameters.get("limit"), LARGEST_REPLY_COUNT), LARGEST_REPLY_COUNT)
            with self._lock:
                wanted = [payload for start, count, payload in self._log if start + count > first][:limit]
            for payload in wanted:
                query.reply(self.key.log, payload, encoding=self._encoding)


def _whole(text: str | None, otherwise: int) -> int:
    return int(text) if text is not None and text.isascii() and text.isdigit() else otherwise
