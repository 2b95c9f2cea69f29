"""Queries to sources' logs through zenoh, whose replies are collected without blocking."""

from collections.abc import Iterator

import zenoh

from formats.wire import ALL_LIVE, Key

MAXIMUM_QUERIES = 64
"""Largest number of logs queried concurrently."""
LARGEST_QUERY = 250
"""Batches requested from a log at a time: replies wait here until they are processed, and 64 logs reply at once."""
LARGEST_ANSWER = 5_000
"""Batches of a reply that may wait to be processed; further ones make the queried source wait, not this one."""
REPLAY_TIMEOUT_S = 2.0


class LogQueries:
    """Queries of logs and of liveliness."""

    def __init__(self, session: zenoh.Session) -> None:
        self._session = session

    def query(self, key: Key, *, first: int, limit: int, epoch: int | None = None) -> "zenoh.Handler[zenoh.Reply]":
        """Query the logs of a machine for batches that hold sample `first` and later ones. epoch: only the log of it
        replies."""
        of = "" if epoch is None else f"epoch={epoch};"
        return self._session.get(
            f"{key.log}?from={first};{of}limit={limit}",
            handler=zenoh.handlers.FifoChannel(LARGEST_ANSWER),
            consolidation=zenoh.ConsolidationMode.NONE,
            timeout=REPLAY_TIMEOUT_S,
            priority=zenoh.Priority.DATA_LOW,
        )

    def query_live_sources(self) -> "zenoh.Handler[zenoh.Reply]":
        """Query which sources are alive."""
        return self._session.liveliness().get(
            ALL_LIVE, handler=zenoh.handlers.FifoChannel(LARGEST_ANSWER), timeout=REPLAY_TIMEOUT_S
        )


def replies_so_far(replies: "zenoh.Handler[zenoh.Reply]") -> "Iterator[zenoh.Reply | None]":
    """Yield the replies that have come, and None when there will be no more."""
    while True:
        try:
            reply = replies.try_recv()
        except zenoh.ZError:  # empty and closed
            yield None
            return
        if reply is None:
            return
        yield reply
