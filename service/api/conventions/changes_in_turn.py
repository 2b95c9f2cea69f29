"""Has requests that change something wait for a place before they take a thread, callers in turn.

Threads are taken in the order of asking: without turns, one person's hundred changes would be made before anybody else's
request is answered.
"""

import inspect
from collections.abc import Callable, Iterator
from contextlib import AsyncExitStack, contextmanager
from typing import TypeVar, cast

from anyio import from_thread
from fastapi import Request
from starlette.types import ASGIApp, Receive, Scope, Send

from service.api.conventions.dependencies import principal
from service.api.conventions.extra_threads import another_thread
from service.api.conventions.request_places import RequestPlaces

READING = frozenset({"GET", "HEAD", "OPTIONS"})
HELD = "held_until_answered"

E = TypeVar("E", bound=Callable[..., object])

_in_turns_of_their_own: set[Callable[..., object]] = set()


def takes_turns_of_its_own(endpoint: E) -> E:
    """Mark an endpoint that waits for a computation, among others in their turn: it holds no place meanwhile.

    It stores the result within `change_place`: all who waited for one computation go on at the same time.
    """
    _in_turns_of_their_own.add(endpoint)
    return endpoint


@contextmanager
def change_place(request: Request) -> Iterator[None]:
    """Hold a place of a change in a thread that serves a request; others use the thread while it waits for the place."""
    places, who = cast(RequestPlaces, request.app.state.changing_places), principal(request).identity
    with another_thread():
        from_thread.run(places.acquire, who)
    try:
        yield
    finally:
        from_thread.run_sync(places.release, who)


class HeldPlaces:
    """ASGI middleware that gives the place of a change to the next when it is answered."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on."""
        if scope["type"] != "http" or scope["method"] in READING:
            await self._app(scope, receive, send)
            return
        async with AsyncExitStack() as held:
            scope[HELD] = held
            await self._app(scope, receive, send)


async def wait_for_turn(request: Request) -> None:
    """Wait for a place if a request, all of which has arrived, changes something; hold the place until the answer is sent."""
    endpoint = request.scope["endpoint"]
    # An asynchronous one takes no thread while it waits.
    if request.method in READING or inspect.iscoroutinefunction(endpoint) or endpoint in _in_turns_of_their_own:
        return
    places, held = cast(RequestPlaces, request.app.state.changing_places), cast(AsyncExitStack, request.scope[HELD])
    await held.enter_async_context(places.place(principal(request).identity, has_gone=request.is_disconnected))
