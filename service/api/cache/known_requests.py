"""Answers requests whose response is cached and current before they are routed: finding the route of a request and checking
its parameters takes longer than all else.
"""

import math
import time
from collections import OrderedDict
from collections.abc import Callable, Hashable
from dataclasses import dataclass

from starlette.responses import Response
from starlette.types import ASGIApp, Receive, Scope, Send

MOST = 2000
"""Requests that are known at a time."""
LONGEST_BYTES = 1000
"""Longer requests are routed each time [B]."""
CHOOSING = frozenset({b"accept", b"accept-encoding", b"accept-language"})
"""Headers by which a client chooses the form of a response."""

ResponseKey = tuple[str, bytes, str | None, bool, Hashable, frozenset[str] | None]
"""Key of a response: path, query, Accept header, whether it is compressed, what else it depends on, the client's plants."""
RequestKey = tuple[str, bytes, tuple[tuple[bytes, bytes], ...], frozenset[str] | None]
"""A request: path, query, the headers by which it chooses, and the plants of who asks."""


@dataclass(frozen=True)
class CachedRequest:
    """A request as the cache knows it.

    asked: key of its response. tables, lately: what that depends on, as `ResponseCache.answer` takes them. until: monotonic
    time from which on the same request asks for something else [s].
    """

    asked: ResponseKey
    tables: tuple[str, ...]
    lately: tuple[str, ...]
    until: float = math.inf


class KnownRequests:
    """Requests that were answered, by how they came, and what they ask for; the newest are kept."""

    def __init__(self) -> None:
        self._known: OrderedDict[RequestKey, CachedRequest] = OrderedDict()

    def learn(self, scope: Scope, request: CachedRequest) -> None:
        """Note what a request asks for."""
        came = _request_key(scope)
        if len(came[0]) + len(came[1]) + sum(len(value) for _, value in came[2]) > LONGEST_BYTES:
            return
        self._known[came] = request
        self._known.move_to_end(came)
        if len(self._known) > MOST:
            self._known.popitem(last=False)

    def find(self, scope: Scope) -> CachedRequest | None:
        """Return what a request asks for; None where that is not known."""
        came = _request_key(scope)
        found = self._known.get(came)
        if found is None or time.monotonic() >= found.until:
            return None
        self._known.move_to_end(came)
        return found


def _request_key(scope: Scope) -> RequestKey:
    chosen = tuple([one for one in scope["headers"] if one[0] in CHOOSING])
    return scope["path"], scope["query_string"], chosen, scope["state"]["principal"].plants


class ResponseCacheMiddleware:
    """ASGI middleware behind the guard that answers from the cache; while requests are traced, all go on to the routes."""

    def __init__(self, app: ASGIApp, cached: Callable[[Scope], Response | None]) -> None:
        """Set up. cached: returns the cached and current response to a request, if there is one."""
        self._app = app
        self._cached = cached

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request, or pass it on."""
        if scope["type"] == "http" and scope["method"] == "GET" and "fastapi.telemetry" not in scope:
            kept = self._cached(scope)
            if kept is not None:
                await kept(scope, receive, send)
                return
        await self._app(scope, receive, send)
