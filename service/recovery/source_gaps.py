"""The gaps of one source, which are requested from its log one after the other."""

from dataclasses import dataclass

import zenoh

from formats.wire import Key
from service.recovery import log_queries
from service.recovery.log_queries import LogQueries
from service.recovery.protocols import BatchSink
from service.write_path.batch import ArrivedBatch


@dataclass
class SourceGaps:
    """Gaps of a source, first and last number each, of which the first one is being requested.

    replies: the log's; None while nothing is requested. replied: whether the log has sent anything. progress: whether
    with anything of the gap.
    """

    key: Key
    gaps: list[tuple[int, int]]
    replies: "zenoh.Handler[zenoh.Reply] | None" = None
    replied: bool = False
    progress: bool = False

    def query(self, queries: LogQueries, *, epoch: int) -> None:
        """Request the first gap, or as much of it as is requested at a time."""
        first, last = self.gaps[0]
        limit = min(last - first + 1, log_queries.LARGEST_QUERY)
        self.replies = queries.query(self.key, first=first, epoch=epoch, limit=limit)
        self.replied = self.progress = False

    def take(self, arrived: ArrivedBatch, *, sink: BatchSink) -> None:
        """Take the part of the first gap that a reply holds."""
        first, last = self.gaps[0]
        begin = arrived.batch.sequence
        if not self.replied:  # the log no longer has earlier samples
            first = max(first, begin)
        if begin <= last:
            sink.take(arrived)
            self.progress, first = True, max(first, arrived.end)
        self.replied = True
        self.gaps[0] = first, last

    def end_query(self) -> None:
        """Go on to the rest of the gap or to the next one after the last reply; to none when the log did not reply."""
        first, last = self.gaps[0]
        self.replies = None
        if not self.replied:
            self.gaps.clear()
        elif first > last or not self.progress:
            self.gaps = [gap for gap in self.gaps[1:] if gap[1] >= first]
