"""Lets requests begin for a millisecond of each iteration of the event loop, clients in turn; liveness checks begin at once.

A request holds the event loop for up to a millisecond or two until it first waits. If forty arrive at once, the loop would run
all forty before it serves anybody else, such as a supervisor that checks whether the service is alive. Quick requests, such as
those that are answered from the cache, begin together.
"""

import asyncio
import hashlib
import time
from collections import OrderedDict, deque
from collections.abc import Collection
from weakref import WeakKeyDictionary

from starlette.types import ASGIApp, Receive, Scope, Send

PERSON = "person"
"""Key in a request's state under which the guard says whom it has let in."""
CREDENTIALS = frozenset({b"authorization", b"cookie"})
"""Headers that carry credentials."""
MOST_LET_IN = 2000
"""Number of credentials that are recorded."""
AT_ONCE_S = 0.001
"""Time in one iteration of the event loop after which no further request begins [s]."""


class FairScheduling:
    """ASGI middleware that lets requests begin in turns.

    Of the waiting requests of one address one begins, then one of the next address's. The people of one address, such as those
    behind a proxy, take its turns in turn: those who have lately been let in with the same Authorization or Cookie header. All
    others of an address, such as who makes up keys, are one.
    Each event loop has turns of its own, as requests of two loops do not hold each other up and cannot wake each other.
    """

    def __init__(self, app: ASGIApp, at_once: Collection[str] = ()) -> None:
        """Set up. at_once: paths whose requests wait for nobody."""
        self._app = app
        self._at_once = frozenset(at_once)
        self._people = RecentCredentials()
        self._turns: WeakKeyDictionary[asyncio.AbstractEventLoop, RoundRobinQueue] = WeakKeyDictionary()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on when its turn has come."""
        if scope["type"] == "http" and scope["path"] not in self._at_once:
            loop = asyncio.get_running_loop()
            turns = self._turns.get(loop) or self._turns.setdefault(loop, RoundRobinQueue())
            await turns.wait(scope, self._people.person(scope))
        await self._app(scope, receive, send)
        self._people.record(scope)


class RecentCredentials:
    """Principals by the credentials with which the guard last admitted them, the newest `MOST_LET_IN`."""

    def __init__(self) -> None:
        self._people: OrderedDict[bytes, str] = OrderedDict()

    def person(self, scope: Scope) -> str:
        """Return who was let in with a request's credentials; "" for everybody else."""
        return self._people.get(_credentials(scope), "")

    def record(self, scope: Scope) -> None:
        """Record whom the guard has let in with a request's credentials, if anybody."""
        person = scope.get("state", {}).get(PERSON, "")
        if person:
            place = _credentials(scope)
            self._people[place] = person
            self._people.move_to_end(place)
            if len(self._people) > MOST_LET_IN:
                self._people.popitem(last=False)


def _credentials(scope: Scope) -> bytes:
    given = (value for name, value in scope.get("headers", ()) if name in CREDENTIALS)
    return hashlib.sha256(b"\n".join(given)).digest()


class RoundRobinQueue:
    """Turns of the requests of one event loop."""

    def __init__(self) -> None:
        self._until: float | None = None
        """Time until which requests begin in this iteration of the loop [s, monotonic]; None while none has begun."""
        self._waiting: OrderedDict[str, OrderedDict[str, deque[asyncio.Future[None]]]] = OrderedDict()
        """Turns by person by address."""

    async def wait(self, scope: Scope, who: str = "") -> None:
        """Wait for a turn of a person of an address; who goes away while waiting is passed over."""
        loop = asyncio.get_running_loop()
        now = time.monotonic()
        if self._until is None:
            self._until = now + AT_ONCE_S
            loop.call_soon(self._next)
        elif self._waiting or now > self._until:
            turn: asyncio.Future[None] = loop.create_future()
            address = scope["client"][0] if scope.get("client") else ""
            self._waiting.setdefault(address, OrderedDict()).setdefault(who, deque()).append(turn)
            await turn

    def _next(self) -> None:
        """Let the next waiting request begin, one iteration after the last began."""
        while self._waiting:
            address, people = self._waiting.popitem(last=False)
            who, turns = people.popitem(last=False)
            turn = turns.popleft()
            if turns:
                people[who] = turns  # behind everybody else of the address
            if people:
                self._waiting[address] = people  # behind everybody else
            if not turn.done():
                turn.set_result(None)
                asyncio.get_running_loop().call_soon(self._next)
                return
        self._until = None
