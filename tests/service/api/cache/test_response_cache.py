"""Answers that are kept: what is asked again is not made again, and nobody is told what is no longer so."""

import asyncio
import gzip
import threading
import time
from collections.abc import Callable
from typing import Any

import pytest
from fastapi import Request, Response

from service.api.cache import response_cache
from service.api.cache.response_cache import LARGEST_KEPT_BYTES, MAXIMUM_CACHE_BYTES, THREADS, ResponseCache
from service.api.conventions.request_places import ClientDisconnected
from service.security.principal import OPEN, Principal
from service.security.role import Role
from storage.database.engine import Database
from storage.machines import machines
from tests.plant import machine

TABLES = ("machines",)


def asked(path: str = "/x", **headers: str) -> Request:
    written = [(name.replace("_", "-").encode(), value.encode()) for name, value in headers.items()]
    about = {"type": "http", "method": "GET", "path": path, "query_string": b"", "headers": written, "server": ("a", 80)}
    return Request(about | {"state": {"principal": OPEN}})


class CountingApp:
    """Answers with how often it was asked; `meanwhile` is done before it answers."""

    def __init__(self, size: int = 1, meanwhile: Callable[[], Any] = lambda: None) -> None:
        self.made = 0
        self._size = size
        self._meanwhile = meanwhile

    def __call__(self) -> Response:
        self.made += 1
        number = self.made
        self._meanwhile()
        return Response(str(number).encode() * self._size, media_type="application/json")


def create(database: Database, name: str) -> None:
    with database.transaction() as session:
        machines.create(session, machine(id=name))


def test_an_answer_is_kept_until_something_is_committed_that_bears_on_it(database: Database) -> None:
    make = CountingApp()

    async def exchange() -> list[bytes]:
        cache, found = ResponseCache(database), []

        async def ask(tables: tuple[str, ...] = TABLES) -> None:
            found.append(bytes((await cache.answer(asked(), tables, make)).body))

        await ask()
        await ask()
        await asyncio.to_thread(create, database, "a")
        await ask()
        await ask()
        await ask(("alerts",))
        await asyncio.to_thread(create, database, "b")
        await ask(("alerts",))
        return found

    # PostgreSQL's mark is one for all tables: nothing was committed between the fourth and the fifth question.
    fifth = b"2" if database.kind == "postgresql" else b"3"
    assert asyncio.run(exchange()) == [b"1", b"1", b"2", b"2", fifth, b"3"]


def test_what_may_be_a_little_behind_is_so_for_a_little_only(database: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    make = CountingApp()

    async def exchange() -> list[bytes]:
        cache, found = ResponseCache(database), []

        async def ask() -> None:
            found.append(bytes((await cache.answer(asked(), ("alerts",), make, lately=TABLES)).body))

        monkeypatch.setattr(response_cache, "LATELY_S", 3600.0)
        await ask()
        await asyncio.to_thread(create, database, "a")
        await ask()
        monkeypatch.setattr(response_cache, "LATELY_S", 0.0)
        await ask()
        await ask()
        await asyncio.to_thread(create, database, "b")
        await ask()
        return found

    # PostgreSQL's mark is one for all tables: there nothing is behind.
    expected = [b"1", b"2", b"2", b"2", b"3"] if database.kind == "postgresql" else [b"1", b"1", b"2", b"2", b"3"]
    assert asyncio.run(exchange()) == expected


def test_what_is_a_little_behind_is_rebuilt_while_nobody_waits(database: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    go_on = threading.Event()
    go_on.set()
    make = CountingApp(meanwhile=lambda: go_on.wait(10))
    monkeypatch.setattr(response_cache, "LATELY_S", 3600.0)
    monkeypatch.setattr(response_cache, "AHEAD_S", 0.0)

    async def exchange() -> list[bytes]:
        cache = ResponseCache(database)

        async def ask() -> bytes:
            return bytes((await cache.answer(asked(), ("alerts",), make, lately=TABLES)).body)

        found = [await ask(), await ask()]
        await asyncio.to_thread(create, database, "a")
        go_on.clear()
        found += [await ask() for _ in range(3)]  # while the next one is under way
        go_on.set()
        while make.made < 2 or cache.computing:
            await asyncio.sleep(0.001)
        return [*found, await ask()]

    if database.kind == "postgresql":
        pytest.skip("its mark is one for all tables: nothing is behind")
    assert asyncio.run(exchange()) == [b"1"] * 5 + [b"2"]
    assert make.made == 2


def test_what_goes_wrong_while_nobody_waits_is_reported_to_who_asks_next(
    database: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail() -> None:
        if make.made > 1:
            raise ValueError("it cannot be made")

    make = CountingApp(meanwhile=fail)
    monkeypatch.setattr(response_cache, "AHEAD_S", 0.0)

    async def exchange() -> None:
        cache = ResponseCache(database)
        await cache.answer(asked(), ("alerts",), make, lately=TABLES)
        await asyncio.to_thread(create, database, "a")
        if database.kind != "postgresql":
            await cache.answer(asked(), ("alerts",), make, lately=TABLES)
        while cache.computing:
            await asyncio.sleep(0.001)
        monkeypatch.setattr(response_cache, "LATELY_S", 0.0)
        with pytest.raises(ValueError, match="cannot be made"):
            await cache.answer(asked(), ("alerts",), make, lately=TABLES)

    asyncio.run(exchange())


def test_what_is_committed_while_an_answer_is_made_is_in_the_next_one(database: Database) -> None:
    make = CountingApp(meanwhile=lambda: create(database, f"m{make.made}"))

    async def exchange() -> list[bytes]:
        cache = ResponseCache(database)
        return [bytes((await cache.answer(asked(), TABLES, make)).body) for _ in range(3)]

    assert asyncio.run(exchange()) == [b"1", b"2", b"3"]


def test_what_many_ask_at_once_is_made_once_and_none_goes_without_it(database: Database) -> None:
    go_on = threading.Event()
    make = CountingApp(meanwhile=lambda: go_on.wait(10))

    async def exchange() -> list[bytes]:
        cache = ResponseCache(database)
        waiting = [asyncio.create_task(cache.answer(asked(), TABLES, make)) for _ in range(5)]
        while not make.made:
            await asyncio.sleep(0.001)
        waiting[0].cancel()  # who began it goes away
        go_on.set()
        return [bytes((await one).body) for one in waiting[1:]]

    assert asyncio.run(exchange()) == [b"1"] * 4


def test_what_differs_in_what_it_depends_on_is_made_apart(database: Database) -> None:
    make = CountingApp()

    async def exchange() -> int:
        cache = ResponseCache(database)
        for request in (asked(), asked("/y"), asked(accept="text/csv"), asked(accept_encoding="gzip")):
            await cache.answer(request, TABLES, make)
        await cache.answer(asked(), TABLES, make, apart=1)
        return make.made

    assert asyncio.run(exchange()) == 5


def test_an_error_is_reported_and_not_kept(database: Database) -> None:
    def wrong() -> Response:
        raise ValueError("no")

    async def exchange() -> None:
        cache = ResponseCache(database)
        with pytest.raises(ValueError, match="no"):
            await cache.answer(asked(), TABLES, wrong)
        assert (await cache.answer(asked(), TABLES, CountingApp())).body == b"1"

    asyncio.run(exchange())


def test_memory_is_bounded(database: Database) -> None:
    huge, large = CountingApp(LARGEST_KEPT_BYTES + 1), CountingApp(LARGEST_KEPT_BYTES // 2)
    many = 2 * MAXIMUM_CACHE_BYTES // (LARGEST_KEPT_BYTES // 2)

    async def exchange() -> None:
        cache = ResponseCache(database)
        for _ in range(2):
            await cache.answer(asked("/huge"), TABLES, huge)
        for number in range(many):
            await cache.answer(asked(f"/{number}"), TABLES, large)
        await cache.answer(asked(f"/{many - 1}"), TABLES, large)
        assert large.made == many
        await cache.answer(asked("/0"), TABLES, large)

    asyncio.run(exchange())
    assert huge.made == 2
    assert large.made == many + 1


def test_large_answers_are_compressed_for_who_takes_it(database: Database) -> None:
    make = CountingApp(5000)

    async def exchange() -> tuple[Response, Response]:
        cache = ResponseCache(database)
        return await cache.answer(asked(accept_encoding="gzip"), TABLES, make), await cache.answer(asked(), TABLES, make)

    small, whole = asyncio.run(exchange())
    assert small.headers["content-encoding"] == "gzip"
    assert gzip.decompress(bytes(small.body)) == b"1" * 5000
    assert whole.body == b"2" * 5000
    assert whole.headers["vary"] == small.headers["vary"] == "Accept-Encoding"


class BusyCallers:
    """Callers who ask at once, of a cache all of whose threads make other answers until `go_on` is set."""

    def __init__(self, database: Database) -> None:
        self.cache, self.go_on, self.order = ResponseCache(database), threading.Event(), list[str]()
        self._begun = threading.Semaphore(0)
        self._tasks = list["asyncio.Task[Response]"]()
        for number in range(THREADS):
            self._asks(f"/first/{number}", "first", self._held)

    def asks(self, path: str, who: str, *, gone: bool = False) -> "asyncio.Task[Response]":
        """Somebody asks for an answer, and hangs up."""

        def make() -> Response:
            self.order.append(path)
            return Response(b"")

        return self._asks(path, who, make, gone=gone)

    async def all_done(self) -> list[int]:
        """Let all be answered; return which requests were not, by their places."""
        ends = time.monotonic() + 30.0
        while self._queued() < len(self._tasks):
            assert time.monotonic() < ends, "all who ask come into the queue"
            await asyncio.sleep(0.01)
        self.go_on.set()
        found = await asyncio.gather(*self._tasks, return_exceptions=True)
        return [place for place, one in enumerate(found[THREADS:]) if isinstance(one, ClientDisconnected)]

    async def no_thread_is_free(self) -> None:
        """Wait until all threads are busy: on PostgreSQL, who asks first does not begin first."""
        for _ in range(THREADS):
            assert await asyncio.to_thread(self._begun.acquire, timeout=10)

    def _queued(self) -> int:
        return sum(len(waiting.have_gone) for waiting, _ in self.cache._under_way.values())

    def _held(self) -> Response:
        self._begun.release()
        assert self.go_on.wait(60)
        return Response(b"")

    def _asks(self, path: str, who: str, make: Callable[[], Response], *, gone: bool = False) -> "asyncio.Task[Response]":
        async def receive() -> dict[str, Any]:
            if not gone:
                await asyncio.sleep(60)
            return {"type": "http.disconnect"}

        state = {"principal": Principal(who, Role.VIEWER, None, "key", f"key {who}")}
        request = Request(dict(asked(path).scope) | {"state": state}, receive)
        self._tasks.append(task := asyncio.create_task(self.cache.answer(request, TABLES, make)))
        return task


def test_one_who_asks_for_very_many_answers_keeps_nobody_waiting(database: Database) -> None:
    async def exchange() -> list[str]:
        busy = BusyCallers(database)
        await busy.no_thread_is_free()
        for number in range(20):
            busy.asks(f"/many/{number}", "impatient")
            await asyncio.sleep(0)
        busy.asks("/own", "anna")
        busy.asks("/many/19", "anna")  # the same as is waited for already
        await busy.all_done()
        return busy.order

    # A busy system may stop the thread of her first answer while those of others come to their end.
    orders = [asyncio.run(exchange()) for _ in range(3)]
    assert min(max(order.index("/own"), order.index("/many/19")) for order in orders) <= 5
    for order in orders:
        assert sorted(order) == sorted({*(f"/many/{number}" for number in range(20)), "/own"})


def test_nothing_is_computed_for_those_who_have_hung_up(database: Database) -> None:
    async def exchange() -> tuple[list[int], list[str]]:
        busy = BusyCallers(database)
        await busy.no_thread_is_free()
        for number in range(3):
            busy.asks(f"/gone/{number}", "impatient", gone=True)
        busy.asks("/gone/1", "anna")
        return await busy.all_done(), busy.order

    gone, order = asyncio.run(exchange())
    assert order == ["/gone/1"]
    assert gone == [0, 2]
