"""The machines with a connected source, and these sources as far as they are known."""

import logging
import time
from collections.abc import Iterator

import zenoh

from formats.wire import IDENTIFIER, Key
from service.recovery.log_queries import LogQueries, replies_so_far
from service.resilience.bounded_dict import BoundedDict
from storage.encoding.source_key import SourceKey

logger = logging.getLogger(__name__)


class LiveSources:
    """Record of the liveliness tokens, checked by roll calls: the arrival of a token may have been missed."""

    def __init__(self, queries: LogQueries) -> None:
        self._queries = queries
        self._live: dict[Key, dict[str, SourceKey]] = {}
        """Per machine with a connected source, the newest start of each of its sources, once known."""
        self._heard_at: BoundedDict[SourceKey, float] = BoundedDict()
        self._liveliness_replies: zenoh.Handler[zenoh.Reply] | None = None

    def __contains__(self, key: Key) -> bool:
        """Return whether a source of a machine is connected."""
        return key in self._live

    def __iter__(self) -> Iterator[Key]:
        """Iterate over the machines with a connected source."""
        return iter(list(self._live))

    def sources(self, key: Key) -> list[SourceKey]:
        """Return the newest start of each source of a machine, as far as it is known."""
        return list(self._live.get(key, {}).values())

    def note_liveliness(self, token: zenoh.Sample) -> Key | None:
        """Note that a source came or went; return the machine of a new one, otherwise None."""
        key = _live_key(token)
        if key is None:
            return None
        if token.kind == zenoh.SampleKind.PUT:
            logger.info("a source of %s/%s is alive", key.plant, key.machine)
            self._live[key] = {}
            return key
        logger.info("no source of %s/%s is alive any more", key.plant, key.machine)
        self._live.pop(key, None)
        self._liveliness_replies = None  # earlier replies may still list it as alive
        return None

    def add(self, key: Key, source: SourceKey) -> bool:
        """Note which source of a machine is connected; return whether that was unknown."""
        known = self._live.get(key)
        if known is None or known.get(source.source) == source:
            return False
        known[source.source] = source
        return True

    def forget_sources(self) -> None:
        """Forget the sources; which machines have some is kept."""
        self._heard_at.clear()
        for key in self._live:
            self._live[key] = {}

    def note_activity(self, source: SourceKey) -> None:
        """Note that samples of a source came."""
        self._heard_at[source] = time.monotonic()

    def is_quiet(self, source: SourceKey, *, quiet_s: float) -> bool:
        """Return whether no samples of a source came for `quiet_s`."""
        return time.monotonic() - self._heard_at.get(source, 0.0) > quiet_s

    def query_live_sources(self) -> None:
        """Query which sources are alive, unless a query is under way."""
        if self._liveliness_replies is None:
            self._liveliness_replies = self._queries.query_live_sources()

    def collect_live_sources(self) -> None:
        """Note the sources that have replied to the roll call."""
        if self._liveliness_replies is None:
            return
        for reply in replies_so_far(self._liveliness_replies):
            if reply is None:
                self._liveliness_replies = None
            elif reply.ok is not None and (key := _live_key(reply.ok)) is not None:
                self._live.setdefault(key, {})


def _live_key(token: zenoh.Sample) -> Key | None:
    """Return the machine of a liveliness token; None for invalid ids: zenoh allows wildcards and spaces."""
    plant, machine = str(token.key_expr).split("/")[3:5]
    return Key(plant, machine) if IDENTIFIER.match(plant) and IDENTIFIER.match(machine) else None
