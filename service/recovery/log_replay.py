"""Replay from sources' logs: they are asked for what follows the last sample known."""

from dataclasses import dataclass

import zenoh

from service.journal.batch import LARGEST_GAP, ArrivedBatch
from service.journal.source_backoff import SourceBackoff
from service.recovery import log_queries
from service.recovery.known_logs import KnownLogs
from service.recovery.log_queries import LogQueries, replies_so_far
from service.recovery.protocols import BatchSink, ReplyReader
from service.resilience.bounded_dict import BoundedDict
from service.wire import Key
from storage.measurements.samples import SourceKey


@dataclass
class Replay:
    """A question to a log that is being answered.

    trusting: a gap in the answer is a gap in the log. Otherwise it may be a damaged reply, which is asked for again.
    """

    key: Key
    first: int
    replies: "zenoh.Handler[zenoh.Reply]"
    trusting: bool
    count: int = 0
    progress: bool = False


class LogReplays:
    """Ask logs, and take what they answer. Nothing here waits."""

    def __init__(
        self, queries: LogQueries, *, sink: BatchSink, reader: ReplyReader, backoff: SourceBackoff, logs: KnownLogs
    ) -> None:
        self._queries = queries
        self._sink = sink
        self._reader = reader
        self._backoff = backoff
        self._logs = logs
        self._replays: dict[SourceKey, Replay] = {}
        self._fruitless: BoundedDict[SourceKey, int] = BoundedDict()
        """From which number on the last question to a log gave nothing new."""

    def __len__(self) -> int:
        """Return how many logs are being asked."""
        return len(self._replays)

    def under_way(self) -> list[SourceKey]:
        """Return the sources whose logs are being asked."""
        return list(self._replays)

    def ask(self, key: Key, source: SourceKey) -> None:
        """Ask a log for what follows the last sample known, unless that is being done, too much else, or none is accepted."""
        if source in self._replays or len(self._replays) >= log_queries.MOST_QUERIES or not self._backoff.accepts(source):
            return
        first = self._sink.next_sequence(source)
        trusting = self._fruitless.get(source) == first
        replies = self._queries.ask(key, first=first, epoch=source.epoch, limit=log_queries.MOST_ASKED)
        self._replays[source] = Replay(key, first, replies, trusting)

    def collect(self, source: SourceKey, *, most: int) -> tuple[int, Replay | None]:
        """Take what a log has answered, at most so many batches; return how many there were, and the replay if it ended."""
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

    def leave(self, source: SourceKey) -> None:
        """Ask a source's log no more."""
        self._replays.pop(source, None)

    def clear(self) -> None:
        """Ask no more."""
        self._replays.clear()

    def forget(self) -> None:
        """Ask no more, and forget what was answered, as after a start."""
        self._replays.clear()
        self._fruitless.clear()

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
            self._fruitless.pop(source, None)
        else:
            self._fruitless[source] = replay.first


def is_behind_gap(arrived: ArrivedBatch, sink: BatchSink) -> bool:
    """Return whether samples before those of a batch have not come."""
    return 0 < arrived.batch.sequence - sink.next_sequence(arrived.source) <= LARGEST_GAP
