"""Caches responses to frequent requests until the tables that they depend on change.

Before each answer the store is asked for changes: a client never gets an answer older than what it has seen committed. Data
that change with every sample are the exception: they may be half a second old. Equal requests at the same time share one
computation. Different ones are computed in turns between callers.
"""

import asyncio
import math
import time
from collections import OrderedDict
from collections.abc import Awaitable, Callable, Hashable, Sequence
from dataclasses import dataclass
from typing import Annotated, cast

from anyio import CapacityLimiter
from anyio.to_thread import run_sync
from fastapi import Depends, Request, Response
from fastapi.concurrency import run_in_threadpool
from starlette.types import Scope

from service.api.cache.known_requests import CachedRequest, KnownRequests, ResponseKey
from service.api.conventions.dependencies import principal
from service.api.conventions.request_places import ClientDisconnected, RequestPlaces
from service.http.compression import COMPRESSED_TYPES, LEAST_COMPRESSED, compressed, takes_gzip
from storage.database.change_counts import Changes
from storage.database.engine import Database

THREADS = 2
"""Threads that compute responses: the work is bound by the processor, and more threads would slow each other down."""
MAXIMUM_CACHE_BYTES = 64 * 1024 * 1024
ENTRY_BYTES = 3000
"""Memory of an entry besides its body and its key [B]: addresses that are answered by an empty list have no end."""
LATELY_S = 0.5
"""Largest age of those parts of a response that change with every sample [s]."""
AHEAD_S = 0.25
"""Age from which such a response is renewed in the background [s]. Requests get the cached one meanwhile."""
LARGEST_KEPT_BYTES = 4 * 1024 * 1024
"""Larger responses are not cached [B]."""


_Origin = tuple[Hashable | None, Sequence[str]]
"""Mark of the tables that a response is made of, and the names of those that may be a little behind."""


@dataclass(frozen=True)
class _CachedResponse:
    """A cached response.

    mark: state of the tables before it was made. lately: state of the tables that may be a little behind. begun: monotonic
    time at which its computation began [s].
    """

    mark: Hashable | None
    lately: Hashable | None
    begun: float
    body: bytes
    media_type: str | None
    headers: dict[str, str]

    def response(self) -> Response:
        return Response(self.body, media_type=self.media_type, headers=self.headers)


@dataclass(frozen=True)
class _Waiting:
    """The turn of a response that is to be computed. have_gone: whether its client has gone, of each request that waits."""

    turn: "asyncio.Future[str]"
    have_gone: list[Callable[[], Awaitable[bool]]]

    async def is_for_nobody(self) -> bool:
        """Check whether all clients have gone; of a request that comes meanwhile, too."""
        for has_gone in self.have_gone:
            if not await has_gone():
                return False
        return True


class ResponseCache:
    """Cached responses by request. An instance belongs to one event loop."""

    def __init__(self, database: Database) -> None:
        self._changes = Changes(database)
        self._entries: OrderedDict[ResponseKey, _CachedResponse] = OrderedDict()
        self._bytes = 0
        self._known = KnownRequests()
        self._threads: CapacityLimiter | None = None
        self._places = RequestPlaces(THREADS, most=THREADS)
        self._under_way: dict[Hashable, tuple[_Waiting, asyncio.Task[_CachedResponse]]] = {}

    @property
    def computing(self) -> int:
        """Count the responses that are being computed."""
        return len(self._under_way)

    async def answer(
        self,
        request: Request,
        tables: Sequence[str],
        make: Callable[[], Response],
        *,
        lately: Sequence[str] = (),
        apart: Hashable = None,
        apart_for_s: float = math.inf,
    ) -> Response:
        """Return the response of `make`, from the cache unless something was committed to the tables that it reads.

        lately: further tables that it reads; commits to them may be LATELY_S behind. apart: what the response depends on
        besides the address, the Accept header and the plants of the client: it follows from these and Accept-Language, for
        apart_for_s [s] from now. Raises what `make` raises.
        """
        zipped = takes_gzip(request.headers.get("accept-encoding", ""))
        path, query = request.scope["path"], request.scope["query_string"]
        asked: ResponseKey = (path, query, request.headers.get("accept"), zipped, apart, principal(request).plants)
        until = time.monotonic() + apart_for_s
        self._known.learn(request.scope, CachedRequest(asked, tuple(tables), tuple(lately), until))
        mark = await self._mark(tables)
        kept = self._entries.get(asked)
        if kept is not None and mark is not None and kept.mark == mark and await self._is_late_enough(kept, lately):
            self._entries.move_to_end(asked)
            if lately and time.monotonic() > kept.begun + AHEAD_S and kept.lately != await self._mark(lately):
                self._begin(asked, (mark, lately), make, request, _never).add_done_callback(_ignore_error)
            return kept.response()
        if mark is None:
            waiting = _Waiting(self._places.turn(principal(request).identity), [request.is_disconnected])
            return (await self._compute_in_turn(waiting, (None, ()), make, zipped=zipped)).response()
        # Shielded: who goes away does not take the answer from the others.
        return (await asyncio.shield(self._begin(asked, (mark, lately), make, request, request.is_disconnected))).response()

    def current(self, scope: Scope) -> Response | None:
        """Return the cached response to a request that was answered before; None where it must be made or looked at anew."""
        known = None if self._changes.waits else self._known.find(scope)
        kept = None if known is None else self._entries.get(known.asked)
        if known is None or kept is None or kept.mark is None or kept.mark != self._changes.mark(known.tables):
            return None
        late = known.lately and time.monotonic() > kept.begun + AHEAD_S
        if late and (kept.lately is None or kept.lately != self._changes.mark(known.lately)):
            return None
        self._entries.move_to_end(known.asked)
        return kept.response()

    async def _is_late_enough(self, kept: _CachedResponse, lately: Sequence[str]) -> bool:
        if not lately or time.monotonic() < kept.begun + LATELY_S:
            return True
        return kept.lately is not None and kept.lately == await self._mark(lately)

    async def _compute_in_turn(
        self, waiting: _Waiting, of: _Origin, make: Callable[[], Response], *, zipped: bool
    ) -> _CachedResponse:
        """Compute a response when its turn comes. Raises ClientDisconnected."""
        waits = not waiting.turn.done()
        who = await self._places.its_turn(waiting.turn)
        try:
            if waits and await waiting.is_for_nobody():
                raise ClientDisconnected
            if self._threads is None:
                self._threads = CapacityLimiter(THREADS)
            mark, lately = of
            late = await self._mark(lately) if lately else None
            return await run_sync(_compute, make, mark, late, zipped, limiter=self._threads)
        finally:
            self._places.release(who)

    async def _mark(self, tables: Sequence[str]) -> Hashable | None:
        if self._changes.waits:
            return await run_in_threadpool(self._changes.mark, tables)
        return self._changes.mark(tables)

    def _begin(
        self,
        asked: ResponseKey,
        of: _Origin,
        make: Callable[[], Response],
        request: Request,
        has_gone: Callable[[], Awaitable[bool]],
    ) -> "asyncio.Task[_CachedResponse]":
        """Start to compute a response, or return the task that already does."""
        who, place = principal(request).identity, (asked, of[0])
        found = self._under_way.get(place)
        if found is None:
            waiting = _Waiting(self._places.turn(who), [])
            task = asyncio.create_task(self._compute_shared(asked, waiting, of, make))
            self._under_way[place] = waiting, task
        else:
            waiting, task = found
            if not waiting.turn.done():
                self._places.take_turns(waiting.turn, who)  # it comes in the turn of either
        waiting.have_gone.append(has_gone)
        return task

    async def _compute_shared(
        self, asked: ResponseKey, waiting: _Waiting, of: _Origin, make: Callable[[], Response]
    ) -> _CachedResponse:
        try:
            kept = await self._compute_in_turn(waiting, of, make, zipped=asked[3])
            self._store(asked, kept)
            return kept
        finally:
            del self._under_way[asked, of[0]]

    def _store(self, asked: ResponseKey, kept: _CachedResponse) -> None:
        if len(kept.body) > LARGEST_KEPT_BYTES:
            return
        earlier = self._entries.pop(asked, None)
        self._bytes += _taken(asked, kept) - (0 if earlier is None else _taken(asked, earlier))
        self._entries[asked] = kept
        while self._bytes > MAXIMUM_CACHE_BYTES:
            self._bytes -= _taken(*self._entries.popitem(last=False))


async def _never() -> bool:
    """Return that an answer for later requests is wanted."""
    return False


def _taken(asked: ResponseKey, kept: _CachedResponse) -> int:
    """Return the memory that an entry takes [B]."""
    address = sum(len(one) for one in asked[:3] if one is not None)
    return ENTRY_BYTES + address + sum(len(value) for value in kept.headers.values()) + len(kept.body)


def _ignore_error(task: "asyncio.Task[_CachedResponse]") -> None:
    """Ignore an error that no request waits for: the next request meets it again."""
    if not task.cancelled():
        task.exception()


def _compute(make: Callable[[], Response], mark: Hashable | None, lately: Hashable | None, zipped: bool) -> _CachedResponse:
    begun = time.monotonic()
    response = make()
    body = bytes(response.body)
    headers = {name: value for name, value in response.headers.items() if name not in ("content-length", "content-type")}
    headers["vary"] = ", ".join([*filter(None, [headers.get("vary")]), "Accept-Encoding"])
    kind = (response.media_type or "").partition(";")[0]
    if zipped and kind in COMPRESSED_TYPES and len(body) >= LEAST_COMPRESSED:
        body = compressed(body)
        headers["content-encoding"] = "gzip"
    return _CachedResponse(mark, lately, begun, body, response.media_type, headers)


async def _response_cache(request: Request) -> ResponseCache:
    return cast(ResponseCache, request.app.state.response_cache)


Cached = Annotated[ResponseCache, Depends(_response_cache)]
