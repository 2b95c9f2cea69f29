"""Lets one request begin in each iteration of the event loop, clients in turn; whether the service is alive is told at once.

Until it first waits, a request holds the event loop for a millisecond or two. Of forty that come at once the loop would run
all, one after the other, before it looks again who else asks, such as a supervisor who asks whether the service is alive.
"""

import asyncio
from collections import OrderedDict, deque
from collections.abc import Collection
from weakref import WeakKeyDictionary

from starlette.types import ASGIApp, Receive, Scope, Send


class Beginnings:
    """ASGI middleware that lets requests begin one by one.

    Clients are told apart by their address: of the waiting requests of one client one begins, then one of the next client's.
    Each event loop has turns of its own, as requests of two loops do not hold each other up and cannot wake each other.
    """

    def __init__(self, app: ASGIApp, at_once: Collection[str] = ()) -> None:
        """Set up. at_once: paths whose requests wait for nobody."""
        self._app = app
        self._at_once = frozenset(at_once)
        self._turns: WeakKeyDictionary[asyncio.AbstractEventLoop, TurnsToBegin] = WeakKeyDictionary()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on when its turn has come."""
        if scope["type"] == "http" and scope["path"] not in self._at_once:
            loop = asyncio.get_running_loop()
            turns = self._turns.get(loop) or self._turns.setdefault(loop, TurnsToBegin())
            await turns.wait(scope["client"][0] if scope.get("client") else "")
        await self._app(scope, receive, send)


class TurnsToBegin:
    """Turns of the requests of one event loop."""

    def __init__(self) -> None:
        self._one_began = False
        """Whether a request began in this iteration of the loop."""
        self._waiting: OrderedDict[str, deque[asyncio.Future[None]]] = OrderedDict()

    async def wait(self, client: str) -> None:
        """Wait for a turn of a client; who goes away while waiting is passed over."""
        loop = asyncio.get_running_loop()
        if self._one_began:
            turn: asyncio.Future[None] = loop.create_future()
            self._waiting.setdefault(client, deque()).append(turn)
            await turn
        else:
            self._one_began = True
            loop.call_soon(self._next)

    def _next(self) -> None:
        """Let the next waiting request begin, in the iteration after the one in which the last one began."""
        while self._waiting:
            client, turns = self._waiting.popitem(last=False)
            turn = turns.popleft()
            if turns:
                self._waiting[client] = turns  # behind everybody else
            if not turn.done():
                turn.set_result(None)
                asyncio.get_running_loop().call_soon(self._next)
                return
        self._one_began = False
