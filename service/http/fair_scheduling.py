"""Lets requests begin for a millisecond of each iteration of the event loop, clients in turn; liveness checks begin at once.

A request holds the event loop for up to a millisecond or two until it first waits. If forty arrive at once, the loop would run
all forty before it serves anybody else, such as a supervisor that checks whether the service is alive. Quick requests, such as
those that are answered from the cache, begin together.
"""

import asyncio
import time
from collections import OrderedDict, deque
from collections.abc import Collection
from weakref import WeakKeyDictionary

from starlette.types import ASGIApp, Receive, Scope, Send

AT_ONCE_S = 0.001
"""Time in one iteration of the event loop after which no further request begins [s]."""


class FairScheduling:
    """ASGI middleware that lets requests begin in turns.

    Clients are told apart by their address: of the waiting requests of one client one begins, then one of the next client's.
    Each event loop has turns of its own, as requests of two loops do not hold each other up and cannot wake each other.
    """

    def __init__(self, app: ASGIApp, at_once: Collection[str] = ()) -> None:
        """Set up. at_once: paths whose requests wait for nobody."""
        self._app = app
        self._at_once = frozenset(at_once)
        self._turns: WeakKeyDictionary[asyncio.AbstractEventLoop, RoundRobinQueue] = WeakKeyDictionary()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on when its turn has come."""
        if scope["type"] == "http" and scope["path"] not in self._at_once:
            loop = asyncio.get_running_loop()
            turns = self._turns.get(loop) or self._turns.setdefault(loop, RoundRobinQueue())
            await turns.wait(scope["client"][0] if scope.get("client") else "")
        await self._app(scope, receive, send)


class RoundRobinQueue:
    """Turns of the requests of one event loop."""

    def __init__(self) -> None:
        self._until: float | None = None
        """Time until which requests begin in this iteration of the loop [s, monotonic]; None while none has begun."""
        self._waiting: OrderedDict[str, deque[asyncio.Future[None]]] = OrderedDict()

    async def wait(self, client: str) -> None:
        """Wait for a turn of a client; who goes away while waiting is passed over."""
        loop = asyncio.get_running_loop()
        now = time.monotonic()
        if self._until is None:
            self._until = now + AT_ONCE_S
            loop.call_soon(self._next)
        elif self._waiting or now > self._until:
            turn: asyncio.Future[None] = loop.create_future()
            self._waiting.setdefault(client, deque()).append(turn)
            await turn

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
        self._until = None
