"""Discovery of sources: the log of a machine whose source is not known yet is asked for any batch, which tells."""

from collections.abc import Iterator

import zenoh

from service.log_queries import LogQueries, replies_so_far
from service.recovery_protocols import ReplyReader
from service.wire import Key
from storage.samples import SourceKey


class LogDiscovery:
    """Ask logs whose they are. Nothing here waits."""

    def __init__(self, queries: LogQueries, *, reader: ReplyReader) -> None:
        self._queries = queries
        self._reader = reader
        self._asked: dict[Key, zenoh.Handler[zenoh.Reply]] = {}

    def __len__(self) -> int:
        """Return of how many machines the logs are being asked."""
        return len(self._asked)

    def ask(self, key: Key) -> None:
        """Ask the logs of a machine, unless that is being done."""
        if key not in self._asked:
            self._asked[key] = self._queries.ask(key, first=0, limit=1)

    def collect(self) -> Iterator[tuple[Key, SourceKey]]:
        """Yield the sources whose logs have answered."""
        for key in list(self._asked):
            for reply in replies_so_far(self._asked[key]):
                if reply is None:
                    del self._asked[key]
                    break
                arrived = None if reply.ok is None else self._reader.replied(key, reply.ok)
                if arrived is not None:
                    yield key, arrived.source

    def clear(self) -> None:
        """Ask no more."""
        self._asked.clear()
