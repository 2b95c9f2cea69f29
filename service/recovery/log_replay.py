"""Replay from sources' logs: they are queried for what follows the last known sample."""

from dataclasses import dataclass

import zenoh

from formats.wire import Key
from service.recovery import log_queries
from service.recovery.known_logs import KnownLogs
from service.recovery.log_queries import LogQueries, replies_so_far
from service.recovery.protocols import BatchSink, ReplyReader
from service.resilience.bounded_dict import BoundedDict
from service.write_path.batch import LARGEST_GAP, ArrivedBatch
from service.write_path.source_backoff import SourceBackoff
from storage.encoding.source_key import SourceKey


@dataclass
class Replay:
    """A query to a log that is being replied to.

    trusting: a gap in the reply is a gap in the log. Otherwise it may come from a damaged reply, which is requested again.
    """

    key: Key
    first: int
    replies: "zenoh.Handler[zenoh.Reply]"
    trusting: bool
    count: int = 0
    progress: bool = False


class LogReplays:
    """Queries of logs for the newest samples, and processing of the replies. Nothing here blocks."""

    def __init__(
        self, queries: LogQueries, *, sink: BatchSink, reader: ReplyReader, backoff: SourceBackoff, logs: KnownLogs
    ) -> None:
        self._queries = queries
        self._sink = sink
        self._reader = reader
        self._backoff = backoff
        self._logs = logs
        self._replays: dict[SourceKey, Replay] = {}
        self._empty_replies: BoundedDict[SourceKey, int] = BoundedDict()
        """First number of the last query to a log, when it gave nothing new."""

    def __len__(self) -> int:
        """Return how many logs are being queried."""
        return len(self._replays)

    def under_way(self) -> list[SourceKey]:
        """Return the sources whose logs are being queried."""
        return list(self._replays)

    def query(self, key: Key, source: SourceKey) -> None:
        """Query a log for what follows the last known sample, unless it is being queried, too many are, or the source is
        paused."""
        if source in self._replays or len(self._replays) >= log_queries.MAXIMUM_QUERIES or not self._backoff.accepts(source):
            return
        first = self._sink.next_sequence(source)
        trusting = self._empty_replies.get(source) == first
        replies = self._queries.query(key, first=first, epoch=source.epoch, limit=log_queries.LARGEST_QUERY)
        self._replays[source] = Replay(key, first, replies, trusting)

    def collect(self, source: SourceKey, *, most: int) -> tuple[int, Replay | None]:
        """Process a log's replies, at most `most` batches; return the number of batches, and the replay if it has ended."""
        replay = self._replays[source]
        count = 0
        self._sink.next_sequence(source)  # asks the database, if it must, before an answer is in hand
        for reply in replies_so_far(replay.replies):
            if reply is None:
                self._end(source, replay)
                return count, replay
            if reply.ok is not None:
                count += 1
                self._take(source, replay, reply.ok)
            if count >= most:
                break
        return count, None

    def drop_source(self, source: SourceKey) -> None:
        """Stop querying a source's log."""
        self._replays.pop(source, None)

    def clear(self) -> None:
        """Stop all queries."""
        self._replays.clear()

    def forget(self) -> None:
        """Stop all queries and forget their results, as after a start."""
        self._replays.clear()
        self._empty_replies.clear()

    def _take(self, source: SourceKey, replay: Replay, reply: zenoh.Sample) -> None:
        arrived = self._reader.replied(replay.key, reply)
        if arrived is not None and arrived.source != source:
            return  # another source of the machine keeps a log too
        self._logs.note_answer(source)
        leading = replay.count == 0
        replay.count += 1
        # What a log begins with is all that it has; a gap behind that is a reply that was damaged or left out.
        if arrived is None or (is_behind_gap(arrived, self._sink) and not (leading or replay.trusting)):
            return
        before = self._sink.next_sequence(source)
        self._sink.take(arrived)
        replay.progress |= self._sink.next_sequence(source) > before

    def _end(self, source: SourceKey, replay: Replay) -> None:
        del self._replays[source]
        if replay.progress:
            self._empty_replies.pop(source, None)
        else:
            self._empty_replies[source] = replay.first


def is_behind_gap(arrived: ArrivedBatch, sink: BatchSink) -> bool:
    """Return whether samples before those of a batch are missing."""
    return 0 < arrived.batch.sequence - sink.next_sequence(arrived.source) <= LARGEST_GAP
