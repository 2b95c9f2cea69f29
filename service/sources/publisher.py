"""A source of samples as an edge device would be one: it numbers its samples, keeps a log and replies to replay queries.

Publishing never blocks on the network and may lose messages on the way (congestion, a restart of the service); the log makes
the store complete. With a `SqliteReplayLog` the source continues with the next number after its process was killed. Sources
without a log work too: what they lose is counted, but not recovered.
"""

import logging
from collections.abc import Callable
from types import TracebackType
from typing import Self

import zenoh

from formats.wire import JSON, MESSAGEPACK, Key, SampleBatch, encode_batch
from service.sources.replay_log import LARGEST_REPLY_COUNT, LogEntry, LogError, MemoryLog, SourceLog

logger = logging.getLogger(__name__)


class Source:
    """One source of one machine. log: its published batches, in memory by default; the source closes it at its end."""

    def __init__(
        self, session: zenoh.Session, key: Key, *, name: str, encoding: str = MESSAGEPACK, log: SourceLog | None = None
    ) -> None:
        self.key = key
        self.name = name
        self.log: SourceLog = MemoryLog() if log is None else log
        self._encoding = encoding
        self._publisher = session.declare_publisher(key.samples, congestion_control=zenoh.CongestionControl.DROP)
        self._queryable = session.declare_queryable(key.log, self._answer)
        self._token = session.liveliness().declare_token(key.live)
        self._session = session
        self._status: zenoh.Queryable[None] | None = None

    def declare_status(self, status: Callable[[], bytes]) -> None:
        """Reply to queries on `…/status` with the JSON that `status` returns."""

        def answer(query: zenoh.Query) -> None:
            with query:
                try:
                    query.reply(self.key.status, status(), encoding=JSON)
                except (LogError, zenoh.ZError) as error:
                    logger.error("a status query is not answered: %s", error)

        self._status = self._session.declare_queryable(self.key.status, answer)

    @property
    def epoch(self) -> int:
        """Return the epoch of the log."""
        return self.log.epoch

    @property
    def sequence(self) -> int:
        """Return the number of the next sample."""
        return self.log.next_sequence

    def publish(self, batch: SampleBatch, *, position: str | None = None) -> None:
        """Log a batch under the next numbers and, once it is logged, send it.

        position: stored with it, to continue from after a restart. Not for concurrent use by several threads. Raises LogError;
        then nothing was numbered, and the batch can be published again.
        """
        batch.source, batch.epoch, batch.sequence = self.name, self.log.epoch, self.log.next_sequence
        payload = encode_batch(batch, self._encoding)
        self.log.append(LogEntry(batch.sequence, len(batch.time_ns), payload, self._encoding, position), logged=self._send)

    def close(self) -> None:
        """Log and send what is pending, then leave the network."""
        self._token.undeclare()
        self._queryable.undeclare()
        if self._status is not None:
            self._status.undeclare()
        self.log.close()
        self._publisher.undeclare()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def _send(self, entry: LogEntry) -> None:
        try:
            self._publisher.put(entry.payload, encoding=entry.encoding)
        except zenoh.ZError as error:
            logger.warning("%s: a batch was not sent, it is in the log: %s", self.key.samples, error)

    def _answer(self, query: zenoh.Query) -> None:
        """Reply to `…/log?from=N;epoch=E;limit=L` with the batches that hold sample N and later ones."""
        parameters = query.parameters
        epoch = parameters.get("epoch")
        with query:
            if epoch is not None and epoch != str(self.log.epoch):
                return
            first = _integer(parameters.get("from"), 0)
            limit = min(_integer(parameters.get("limit"), LARGEST_REPLY_COUNT), LARGEST_REPLY_COUNT)
            try:
                for entry in self.log.entries_from(first, limit):
                    query.reply(self.key.log, entry.payload, encoding=entry.encoding)
            except LogError as error:
                logger.error("a replay query is not answered: %s", error)


def _integer(text: str | None, otherwise: int) -> int:
    return int(text) if text is not None and text.isascii() and text.isdigit() else otherwise
