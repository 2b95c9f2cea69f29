"""Queries to sources' logs by way of zenoh, whose replies are collected without waiting for them."""

from collections.abc import Iterator

import zenoh

from service.wire import ALL_LIVE, Key

MOST_QUERIES = 64
"""Logs asked at the same time."""
MOST_ASKED = 250
"""Batches that a log is asked for at a time: what it answers waits here until it is taken, and 64 logs answer at once."""
LARGEST_ANSWER = 5_000
"""Batches of an answer that may wait to be taken; more hold the asked source up, not this one."""
REPLAY_TIMEOUT_S = 2.0


class LogQueries:
    """Asks logs, and who is alive."""

    def __init__(self, session: zenoh.Session) -> None:
        self._session = session

    def ask(self, key: Key, *, first: int, limit: int, epoch: int | None = None) -> "zenoh.Handler[zenoh.Reply]":
        """Ask the logs of a machine for batches that hold sample `first` and later ones. epoch: of the only one to answer."""
        of = "" if epoch is None else f"epoch={epoch};"
        return self._session.get(
            f"{key.log}?from={first};{of}limit={limit}",
            handler=zenoh.handlers.FifoChannel(LARGEST_ANSWER),
            consolidation=zenoh.ConsolidationMode.NONE,
            timeout=REPLAY_TIMEOUT_S,
            priority=zenoh.Priority.DATA_LOW,
        )

    def call_roll(self) -> "zenoh.Handler[zenoh.Reply]":
        """Ask who is alive."""
        return self._session.liveliness().get(
            ALL_LIVE, handler=zenoh.handlers.FifoChannel(LARGEST_ANSWER), timeout=REPLAY_TIMEOUT_S
        )


def replies_so_far(replies: "zenoh.Handler[zenoh.Reply]") -> "Iterator[zenoh.Reply | None]":
    """Yield the replies that are there, and None when there will be no more."""
    while True:
        try:
            reply = replies.try_recv()
        except zenoh.ZError:  # empty and closed
            yield None
            return
        if reply is None:
            return
        yield reply
