"""Recall of sequence gaps: samples that were counted as lost while a source's log was away are requested when it is back."""

from dataclasses import dataclass

import zenoh

from formats.wire import Key
from service.recovery import log_queries
from service.recovery.known_logs import KnownLogs
from service.recovery.live_sources import LiveSources
from service.recovery.log_queries import LogQueries, replies_so_far
from service.recovery.protocols import BatchSink, GapRecords, ReplyReader
from service.resilience.backoff import Backoff
from service.resilience.bounded_dict import BoundedDict
from service.write_path.source_backoff import SourceBackoff
from storage.encoding.source_key import SourceKey


@dataclass
class _Recall:
    """Gaps of a source, first and last number, which are requested from its log one after the other.

    heard: whether the log has replied with anything. progress: whether with anything of the gap.
    """

    key: Key
    gaps: list[tuple[int, int]]
    replies: "zenoh.Handler[zenoh.Reply] | None" = None
    heard: bool = False
    progress: bool = False


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
        self._recalls: dict[SourceKey, _Recall] = {}
        self._postponed: BoundedDict[SourceKey, None] = BoundedDict()
        """Sources whose gaps are to be requested as soon as their samples are accepted again."""
        self._query_backoff = Backoff[SourceKey]()
        """Logs that did not reply to a request for gaps, though they reply otherwise."""

    def __len__(self) -> int:
        """Return the number of sources whose gaps are being requested."""
        return len(self._recalls)

    def note_live(self, key: Key, source: SourceKey) -> None:
        """Note that a source is live; when it was away before, request its gaps."""
        if self._live.add(key, source):
            self.request(key, source)

    def request(self, key: Key, source: SourceKey) -> None:
        """Request a source's gaps from its log, now or as soon as the source is accepted."""
        self._postponed[source] = None
        if source in self._recalls or not self._backoff.accepts(source):
            return  # the current requests may not include the newest gaps
        gaps = [(gap.first, gap.last) for gap in self._records.sequence_gaps(source)]
        if gaps:
            self._recalls[source] = _Recall(key, gaps)
        del self._postponed[source]

    def postpone(self, source: SourceKey) -> None:
        """Note that a source's gaps are to be requested."""
        self._postponed[source] = None

    def request_postponed(self, key: Key, source: SourceKey) -> None:
        """Request the postponed gaps of a source when they are due."""
        if source in self._postponed and self._query_backoff.is_due(source):
            with self._backoff.pausing_on_error(source):
                self.request(key, source)

    def drop_source(self, source: SourceKey) -> None:
        """Stop requesting a source's gaps until its samples are accepted again."""
        self._recalls.pop(source, None)
        self._postponed[source] = None

    def clear(self) -> None:
        """Drop the current requests."""
        self._recalls.clear()

    def forget(self) -> None:
        """Drop the current and the postponed requests, as after a start."""
        self._recalls.clear()
        self._postponed.clear()
        self._query_backoff = Backoff()

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
                    self._query(source, recall)
        return count

    def _query(self, source: SourceKey, recall: _Recall) -> None:
        first, last = recall.gaps[0]
        limit = min(last - first + 1, log_queries.LARGEST_QUERY)
        recall.replies = self._queries.query(recall.key, first=first, epoch=source.epoch, limit=limit)
        recall.heard = recall.progress = False

    def _collect(self, source: SourceKey, recall: _Recall, replies: "zenoh.Handler[zenoh.Reply]") -> int:
        """Process a log's replies for a gap, then go on to the next one; return the number of batches."""
        count = 0
        self._sink.next_sequence(source)  # queries the database, if necessary, before a reply is taken
        for reply in replies_so_far(replies):
            if reply is None:
                self._end(source, recall)
                break
            if reply.ok is not None and self._take(source, recall, reply.ok):
                count += 1
        if recall.heard:
            self._query_backoff.succeeded(source)
        return count

    def _take(self, source: SourceKey, recall: _Recall, reply: zenoh.Sample) -> bool:
        """Take the part of a gap that a reply holds; return whether it is the source's."""
        first, last = recall.gaps[0]
        arrived = self._reader.replied(recall.key, reply)
        if arrived is None or arrived.source != source:
            return False
        begin = arrived.batch.sequence
        if not recall.heard:  # the log no longer has earlier samples
            first = max(first, begin)
        if begin <= last:
            self._sink.take(arrived)
            recall.progress, first = True, max(first, arrived.end)
        recall.heard = True
        recall.gaps[0] = first, last
        return True

    def _end(self, source: SourceKey, recall: _Recall) -> None:
        """Go on to the rest of the gap or to the next one after the last reply of a log."""
        first, last = recall.gaps[0]
        recall.replies = None
        if not recall.heard:
            recall.gaps.clear()
            self._postpone(source)
        elif first > last or not recall.progress:
            recall.gaps = [gap for gap in recall.gaps[1:] if gap[1] >= first]
        if not recall.gaps:
            del self._recalls[source]

    def _postpone(self, source: SourceKey) -> None:
        """Postpone the gaps of a log that replies otherwise: it may have been delayed."""
        if self._logs.has_answered(source):
            self._query_backoff.failed(source)
            self._postponed[source] = None
