"""Recall of sequence gaps: samples that were counted as lost while a source's log was away are requested when it is back."""

import zenoh

from formats.wire import Key
from service.recovery import log_queries
from service.recovery.known_logs import KnownLogs
from service.recovery.live_sources import LiveSources
from service.recovery.log_queries import LogQueries, replies_so_far
from service.recovery.postponed_recalls import PostponedRecalls
from service.recovery.protocols import BatchSink, GapRecords, ReplyReader
from service.recovery.source_gaps import SourceGaps
from service.write_path.source_backoff import SourceBackoff
from storage.encoding.source_key import SourceKey


class GapRecall:
    """Requests of gaps from logs, and processing of the replies. Nothing here blocks."""

    def __init__(
        self,
        queries: LogQueries,
        *,
        sink: BatchSink,
        records: GapRecords,
        reader: ReplyReader,
        backoff: SourceBackoff,
        live: LiveSources,
        logs: KnownLogs,
    ) -> None:
        self._queries = queries
        self._sink = sink
        self._records = records
        self._reader = reader
        self._backoff = backoff
        self._live = live
        self._logs = logs
        self._recalls: dict[SourceKey, SourceGaps] = {}
        self._postponed = PostponedRecalls()

    def __len__(self) -> int:
        """Return the number of sources whose gaps are being requested."""
        return len(self._recalls)

    def note_live(self, key: Key, source: SourceKey) -> None:
        """Note that a source is live; when it was away before, request its gaps."""
        if self._live.add(key, source):
            self.request(key, source)

    def request(self, key: Key, source: SourceKey) -> None:
        """Request a source's gaps from its log, now or as soon as the source is accepted."""
        self._postponed.add(source)
        if source in self._recalls or not self._backoff.accepts(source):
            return  # the current requests may not include the newest gaps
        gaps = [(gap.first, gap.last) for gap in self._records.sequence_gaps(source)]
        if gaps:
            self._recalls[source] = SourceGaps(key, gaps)
        self._postponed.remove(source)

    def postpone(self, source: SourceKey) -> None:
        """Note that a source's gaps are to be requested."""
        self._postponed.add(source)

    def request_postponed(self, key: Key, source: SourceKey) -> None:
        """Request the postponed gaps of a source when they are due."""
        if self._postponed.is_due(source):
            with self._backoff.pausing_on_error(source):
                self.request(key, source)

    def drop_source(self, source: SourceKey) -> None:
        """Stop requesting a source's gaps until its samples are accepted again."""
        self._recalls.pop(source, None)
        self._postponed.add(source)

    def clear(self) -> None:
        """Drop the current requests."""
        self._recalls.clear()

    def forget(self) -> None:
        """Drop the current and the postponed requests, as after a start."""
        self._recalls.clear()
        self._postponed = PostponedRecalls()

    def collect(self) -> int:
        """Process the replies of logs and request the next gaps; return the number of batches."""
        count = 0
        room = log_queries.MAXIMUM_QUERIES - sum(one.replies is not None for one in self._recalls.values())
        for source, recall in list(self._recalls.items()):
            with self._backoff.pausing_on_error(source):
                if recall.replies is not None:
                    count += self._collect(source, recall, recall.replies)
                elif room > 0:
                    room -= 1
                    recall.query(self._queries, epoch=source.epoch)
        return count

    def _collect(self, source: SourceKey, recall: SourceGaps, replies: "zenoh.Handler[zenoh.Reply]") -> int:
        """Process a log's replies for a gap, then go on to the next one; return the number of batches."""
        count = 0
        self._sink.next_sequence(source)  # queries the database, if necessary, before a reply is taken
        for reply in replies_so_far(replies):
            if reply is None:
                self._end(source, recall)
                break
            arrived = None if reply.ok is None else self._reader.replied(recall.key, reply.ok)
            if arrived is not None and arrived.source == source:
                recall.take(arrived, sink=self._sink)
                count += 1
        if recall.replied:
            self._postponed.succeeded(source)
        return count

    def _end(self, source: SourceKey, recall: SourceGaps) -> None:
        """Go on to the next part or gap after the last reply of a log; ask one later that replies otherwise."""
        recall.end_query()
        if not recall.replied and self._logs.has_answered(source):
            self._postponed.failed(source)
        if not recall.gaps:
            del self._recalls[source]
