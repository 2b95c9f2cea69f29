"""Limits how many requests read from the store, or change it, at once, and serves callers in turn.

A request holds its connection to the database from its first query on, also while it waits for a thread to go on in. More of
them than there are connections would wait for each other: those with a thread for a connection, those with a connection for a
thread. A request that waits for a place has neither. Callers take turns, one request of each at a time, and no caller
holds all places. A request whose caller has gone is not begun.
"""

import asyncio
from collections import Counter, OrderedDict, deque
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager

from estimator.errors import Unavailable

READERS = 6
"""Requests that read at a time: fewer than a store has connections, as many as there are threads."""
WRITERS = 4
"""Requests that change something at a time: the store makes one change at a time, and threads are left for those that read."""


class ClientDisconnected(Unavailable):
    """The client has gone before its request began to be handled."""

    def __init__(self) -> None:
        super().__init__("the client has gone: nothing was done")


class RequestPlaces:
    """Places of one application's requests; all of its methods run on the server's event loop."""

    def __init__(self, places: int, *, most: int | None = None) -> None:
        """Set up. most: places that one caller may hold; by default all but one."""
        self._free = places
        self._most = max(places - 1, 1) if most is None else most
        self._held: Counter[str] = Counter()
        self._waiting: OrderedDict[str, deque[asyncio.Future[str]]] = OrderedDict()

    @asynccontextmanager
    async def place(self, who: str, *, has_gone: Callable[[], Awaitable[bool]]) -> AsyncIterator[None]:
        """Hold a place, after waiting for it. who: whose request it is; has_gone: whether its client has gone.

        Raises ClientDisconnected: whoever asks and hangs up again and again would have the service work for nobody.
        """
        turn = self.turn(who)
        waits = not turn.done()
        await self.its_turn(turn)
        try:
            if waits and await has_gone():
                raise ClientDisconnected
            yield
        finally:
            self.release(who)

    async def acquire(self, who: str) -> None:
        """Wait for a place, and hold it until it is released. who: whose request it is."""
        await self.its_turn(self.turn(who))

    def turn(self, who: str) -> "asyncio.Future[str]":
        """Return what is done when a place is held; its result is in whose turn, who must release it."""
        turn: asyncio.Future[str] = asyncio.get_running_loop().create_future()
        if self._free and self._held[who] < self._most:
            self._hold(who)
            turn.set_result(who)
        else:
            self.take_turns(turn, who)
        return turn

    def take_turns(self, turn: "asyncio.Future[str]", who: str) -> None:
        """Let a turn that is waited for come among those of another caller, too."""
        self._waiting.setdefault(who, deque()).append(turn)

    async def its_turn(self, turn: "asyncio.Future[str]") -> str:
        """Wait for a turn; return whose it is. Whoever gives up meanwhile leaves the place to others."""
        try:
            return await turn
        except asyncio.CancelledError:
            if turn.done() and not turn.cancelled():
                self.release(turn.result())  # the place had been given already
            raise

    def release(self, who: str) -> None:
        """Give a place to whoever is next."""
        self._free += 1
        self._held[who] -= 1
        if not self._held[who]:
            del self._held[who]
        while self._free and (following := self._following()) is not None:
            self._hold(following)
            self._waiting.move_to_end(following)  # behind everybody else
            self._waiting[following].popleft().set_result(following)

    def _hold(self, who: str) -> None:
        self._free -= 1
        self._held[who] += 1

    def _following(self) -> str | None:
        """Return the waiting caller whose turn it is among those below their limit of places."""
        for who, turns in list(self._waiting.items()):
            while turns and turns[0].done():  # it came among another's, or whoever waited has gone
                turns.popleft()
            if not turns:
                del self._waiting[who]
            elif self._held[who] < self._most:
                return who
        return None
