"""Limits how many requests read from the store, or change it, at once, and serves callers in turn.

A request holds its connection to the database from its first query on, also while it waits for a thread to go on in. More of
them than there are connections would wait for each other: those with a thread for a connection, those with a connection for a
thread. A request that waits for a place has neither. Of the waiting requests of one caller one is served, then one of the next
caller's, and no caller holds all places.
"""

import asyncio
from collections import Counter, OrderedDict, deque
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

READERS = 6
"""Requests that read at a time: fewer than a store has connections, as many as there are threads."""
WRITERS = 4
"""Requests that change something at a time: the store makes one change at a time, and threads are left for those that read."""


class RequestPlaces:
    """Places of one application's requests; all of its methods run on the server's event loop."""

    def __init__(self, places: int) -> None:
        self._free = places
        self._most = max(places - 1, 1)
        """Places that one caller may hold."""
        self._held: Counter[str] = Counter()
        self._waiting: OrderedDict[str, deque[asyncio.Future[None]]] = OrderedDict()

    @asynccontextmanager
    async def place(self, who: str) -> AsyncIterator[None]:
        """Hold a place, after waiting for it. who: whose request it is."""
        await self.acquire(who)
        try:
            yield
        finally:
            self.release(who)

    async def acquire(self, who: str) -> None:
        """Wait for a place, and hold it until it is released. who: whose request it is."""
        if self._free and self._held[who] < self._most:
            self._hold(who)
            return
        turn: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._waiting.setdefault(who, deque()).append(turn)
        try:
            await turn
        except asyncio.CancelledError:
            if turn.done() and not turn.cancelled():
                self.release(who)  # the place had been given already
            raise

    def _hold(self, who: str) -> None:
        self._free -= 1
        self._held[who] += 1

    def release(self, who: str) -> None:
        """Give a place to whoever is next."""
        self._free += 1
        self._held[who] -= 1
        if not self._held[who]:
            del self._held[who]
        while self._free and (following := self._following()) is not None:
            turns = self._waiting[following]
            turn = turns.popleft()
            if turns:
                self._waiting.move_to_end(following)  # behind everybody else
            else:
                del self._waiting[following]
            if not turn.done():  # whoever waited is still there
                self._hold(following)
                turn.set_result(None)

    def _following(self) -> str | None:
        """Return the caller whose turn it is, of those who may hold one more place."""
        return next((who for who in self._waiting if self._held[who] < self._most), None)
