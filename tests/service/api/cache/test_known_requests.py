"""Requests that are answered before they are routed: only what is current, to those whom it is for, in their form."""

import asyncio
from typing import Any

import pytest
from fastapi import Request, Response

from service.api.cache import known_requests, response_cache
from service.api.cache.known_requests import CachedRequest, KnownRequests, ResponseKey
from service.api.cache.response_cache import ResponseCache
from service.security.principal import OPEN, Principal
from service.security.role import Role
from storage.database.engine import Database
from tests.service.api.cache.test_response_cache import TABLES, CountingApp, asked, create

ASKED: ResponseKey = ("/x", b"", None, False, None, None)


def of_plants(request: Request, *plants: str) -> Request:
    who = Principal("Ada", Role.VIEWER, frozenset(plants), "key", "key abc")
    return Request({**request.scope, "state": {"principal": who}})


def current(cache: ResponseCache, request: Request) -> bytes | None:
    found = cache.current(request.scope)
    return None if found is None else bytes(found.body)


def needs_counts(database: Database) -> None:
    if database.kind == "postgresql":
        pytest.skip("reading its mark waits for another process: every request is routed")


def test_a_request_is_answered_at_once_until_something_is_committed(database: Database) -> None:
    needs_counts(database)
    make = CountingApp()

    async def exchange() -> list[bytes | None]:
        cache = ResponseCache(database)
        found = [current(cache, asked())]
        await cache.answer(asked(), TABLES, make)
        found.append(current(cache, asked()))
        await asyncio.to_thread(create, database, "a")
        found.append(current(cache, asked()))
        await cache.answer(asked(), TABLES, make)
        return [*found, current(cache, asked())]

    assert asyncio.run(exchange()) == [None, b"1", None, b"2"]


def test_others_are_not_answered_with_it(database: Database) -> None:
    needs_counts(database)

    async def exchange() -> list[bytes | None]:
        cache = ResponseCache(database)
        await cache.answer(of_plants(asked(accept_language="de"), "mill"), TABLES, CountingApp())
        others = (
            asked(accept_language="de"),
            of_plants(asked(accept_language="de"), "orchard"),
            of_plants(asked(accept_language="en"), "mill"),
            of_plants(asked("/y", accept_language="de"), "mill"),
            of_plants(asked(accept_language="de", accept="text/csv"), "mill"),
            of_plants(asked(accept_language="de", accept_encoding="gzip"), "mill"),
        )
        return [current(cache, one) for one in (*others, of_plants(asked(accept_language="de"), "mill"))]

    assert asyncio.run(exchange()) == [None] * 6 + [b"1"]


def test_what_changes_with_every_sample_is_as_new_as_when_it_is_routed(
    database: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    needs_counts(database)
    monkeypatch.setattr(response_cache, "AHEAD_S", 0.0)

    async def exchange() -> list[bytes | None]:
        cache = ResponseCache(database)
        await cache.answer(asked(), ("alerts",), CountingApp(), lately=TABLES)
        found = [current(cache, asked())]
        await asyncio.to_thread(create, database, "a")
        return [*found, current(cache, asked())]

    assert asyncio.run(exchange()) == [b"1", None]


def test_what_follows_from_the_time_holds_for_its_time() -> None:
    known = KnownRequests()
    known.learn(asked().scope, CachedRequest(ASKED, TABLES, (), until=0.0))
    assert known.find(asked().scope) is None


def test_no_more_is_known_than_has_room(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(known_requests, "MOST", 2)
    known = KnownRequests()
    for path in ("/a", "/b", "/c"):
        known.learn(asked(path).scope, CachedRequest(ASKED, TABLES, ()))
    known.learn(asked("/long", accept="x" * 2000).scope, CachedRequest(ASKED, TABLES, ()))
    assert [known.find(asked(path).scope) is not None for path in ("/a", "/b", "/c")] == [False, True, True]
    assert known.find(asked("/long", accept="x" * 2000).scope) is None


def test_addresses_without_end_whose_answers_are_empty_take_no_more_room(
    database: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    def make() -> Response:
        return Response(b"[]", media_type="application/json")

    monkeypatch.setattr(response_cache, "MAXIMUM_CACHE_BYTES", 50_000)

    async def exchange() -> Any:
        cache = ResponseCache(database)
        for number in range(100):
            await cache.answer(asked(f"/x/{number}"), TABLES, make)
        return len(cache._entries)

    assert 1 < asyncio.run(exchange()) < 20


def test_open_requests_are_known_by_themselves() -> None:
    known = KnownRequests()
    known.learn(asked().scope, CachedRequest(ASKED, TABLES, ()))
    assert asked().scope["state"]["principal"] is OPEN
    assert known.find(asked().scope) is not None
