"""Logs of quiet sources: they are queried, as soon as there is room, for samples that were published and never came.

While a machine's source is unknown, the machine's logs are first queried for any batch, which identifies it.
"""

import zenoh

from formats.wire import Key
from service.recovery import log_queries
from service.recovery.gap_recall import GapRecall
from service.recovery.known_logs import KnownLogs
from service.recovery.live_sources import LiveSources
from service.recovery.log_queries import LogQueries, replies_so_far
from service.recovery.log_replay import LogReplays
from service.recovery.protocols import ReplyReader
from service.write_path.source_backoff import SourceBackoff
from storage.encoding.source_key import SourceKey


class QuietLogs:
    """Queue of logs to be queried, the longest waiting first. Nothing here blocks."""

    def __init__(
        self,
        queries: LogQueries,
        *,
        reader: ReplyReader,
        backoff: SourceBackoff,
        live: LiveSources,
        logs: KnownLogs,
        replays: LogReplays,
        recall: GapRecall,
    ) -> None:
        self._queries = queries
        self._reader = reader
        self._backoff = backoff
        self._live = live
        self._logs = logs
        self._replays = replays
        self._recall = recall
        self._to_ask: dict[tuple[Key, SourceKey | None], None] = {}
        self._discoveries: dict[Key, zenoh.Handler[zenoh.Reply]] = {}
        """Machines whose sources are being queried."""

    def __len__(self) -> int:
        """Return the number of machines whose sources are being queried."""
        return len(self._discoveries)

    def add(self, key: Key, source: SourceKey | None = None) -> None:
        """Queue a source's log for a query. source: None for the machine's logs whose sources are not known yet."""
        self._to_ask.setdefault((key, source))

    def collect(self) -> None:
        """Query the logs of newly identified sources, then as many queued ones as there is room for."""
        for key in list(self._discoveries):
            self._collect_discovery(key)
        while self._to_ask and len(self._discoveries) + len(self._replays) < log_queries.MAXIMUM_QUERIES:
            key, source = next(iter(self._to_ask))
            del self._to_ask[key, source]
            self._query(key, source)

    def clear(self) -> None:
        """Stop all queries and empty the queue."""
        self._to_ask.clear()
        self._discoveries.clear()

    def _query(self, key: Key, source: SourceKey | None) -> None:
        if source is not None:
            with self._backoff.pausing_on_error(source):
                self._replays.query(key, source)
        elif key in self._live and key not in self._discoveries:
            self._discoveries[key] = self._queries.query(key, first=0, limit=1)

    def _collect_discovery(self, key: Key) -> None:
        for reply in replies_so_far(self._discoveries[key]):
            if reply is None:
                del self._discoveries[key]
                return
            arrived = None if reply.ok is None else self._reader.replied(key, reply.ok)
            if arrived is not None and key in self._live:
                source = arrived.source
                self._logs.note_answer(source)
                with self._backoff.pausing_on_error(source):
                    self._recall.note_live(key, source)
                    self._replays.query(key, source)
