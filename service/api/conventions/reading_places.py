"""Limits how many requests read from the store at once, and serves callers in turn.

A request holds its connection to the database from its first query on, also while it waits for a thread to go on in. More of
them than there are connections would wait for each other: those with a thread for a connection, those with a connection for a
thread. A request that waits for a place has neither. Of the waiting requests of one caller one is served, then one of the next
caller's.
"""

import asyncio
from collections import OrderedDict, deque
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

READERS = 6
"""Requests that read at a time: fewer than a store has connections, as many as there are threads."""


class ReadingPlaces:
    """The places of one application; all of its methods run on the server's event loop."""

    def __init__(self, places: int = READERS) -> None:
        self._free = places
        self._waiting: OrderedDict[str, deque[asyncio.Future[None]]] = OrderedDict()

    @asynccontextmanager
    async def place(self, who: str) -> AsyncIterator[None]:
        """Hold a place, after waiting for it. who: whose request it is."""
        await self._take(who)
        try:
            yield
        finally:
            self._give()

    async def _take(self, who: str) -> None:
        if self._free:
            self._free -= 1
            return
        turn: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._waiting.setdefault(who, deque()).append(turn)
        try:
            await turn
        except asyncio.CancelledError:
            if turn.done() and not turn.cancelled():
                self._give()  # the place had been given already
            raise

    def _give(self) -> None:
        while self._waiting:
            who, turns = self._waiting.popitem(last=False)
            turn = turns.popleft()
            if turns:
                self._waiting[who] = turns  # behind everybody else
            if not turn.done():  # whoever waited is still there
                turn.set_result(None)
                return
        self._free += 1
