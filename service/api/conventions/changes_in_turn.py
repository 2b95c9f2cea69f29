"""Has requests that change something wait for a place before they take a thread, callers in turn.

Threads are taken in the order of asking: without turns, one person's hundred changes would be made before anybody else's
request is answered.
"""

import inspect
from collections.abc import AsyncIterator, Callable
from contextlib import AsyncExitStack
from typing import TypeVar, cast

from fastapi import Depends, Request

from service.api.conventions.dependencies import principal
from service.api.conventions.request_places import RequestPlaces

READING = frozenset({"GET", "HEAD", "OPTIONS"})

E = TypeVar("E", bound=Callable[..., object])

_in_turns_of_their_own: set[Callable[..., object]] = set()


def takes_turns_of_its_own(endpoint: E) -> E:
    """Mark an endpoint that waits for a computation, among others in their turn: it holds no place meanwhile."""
    _in_turns_of_their_own.add(endpoint)
    return endpoint


async def _change_in_turn(request: Request) -> AsyncIterator[None]:
    endpoint = request.scope["endpoint"]
    # An asynchronous one takes no thread while it waits.
    elsewhere = inspect.iscoroutinefunction(endpoint) or endpoint in _in_turns_of_their_own
    async with AsyncExitStack() as held:
        if request.method not in READING and not elsewhere:
            places = cast(RequestPlaces, request.app.state.changing_places)
            await held.enter_async_context(places.place(principal(request).identity))
        yield


CHANGE_IN_TURN = Depends(_change_in_turn, scope="function")
"""Dependency of all operations."""
