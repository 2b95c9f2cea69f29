"""Many requests at once are all answered: none waits for another, and nobody's many keep another person's one waiting."""

import asyncio
from contextlib import AsyncExitStack
from typing import Any

import httpx
import pytest
from anyio.to_thread import current_default_thread_limiter

from service.api.application import THREADS
from service.api.conventions.request_places import ClientDisconnected, RequestPlaces
from service.security import api_keys
from service.security.configuration import Security
from service.security.role import Role
from storage.database.engine import Database
from tests.api_in_process import PREFIX, Api

AT_ONCE = 120
"""More than there are connections and threads together."""
PATIENCE_S = 20.0
"""Less than a request waits for a connection before it fails."""


async def never() -> bool:
    """The client stays."""
    return False


async def always() -> bool:
    """The client has gone."""
    return True


@pytest.mark.parametrize("path", ["/sources", "/machines/pump-7/jobs", "/machines/pump-7/timeline", "/alerts"])
def test_more_requests_at_once_than_connections_are_all_answered(api: Api, path: str) -> None:
    async def ask() -> set[int]:
        transport = httpx.ASGITransport(api.app)
        async with httpx.AsyncClient(transport=transport, base_url="http://rundown") as client:
            asked = [client.get(f"{PREFIX}{path}", params={"limit": 1 + number}) for number in range(AT_ONCE)]
            return {answer.status_code for answer in await asyncio.gather(*asked)}

    assert asyncio.run(asyncio.wait_for(ask(), PATIENCE_S)) == {200}


def test_people_are_served_in_turn() -> None:
    async def served() -> list[str]:
        places, order = RequestPlaces(1), []

        async def one(who: str) -> None:
            async with places.place(who, has_gone=never):
                order.append(who)
                await asyncio.sleep(0)

        impatient = [asyncio.create_task(one("impatient")) for _ in range(50)]
        await asyncio.sleep(0)
        others = [asyncio.create_task(one(who)) for who in ("anna", "bert")]
        await asyncio.gather(*impatient, *others)
        return order

    order = asyncio.run(served())
    assert max(order.index("anna"), order.index("bert")) <= 4


def test_one_caller_cannot_hold_all_places() -> None:
    async def served() -> None:
        places, free = RequestPlaces(3), asyncio.Event()

        async def one() -> None:
            async with places.place("impatient", has_gone=never):
                await free.wait()

        impatient = [asyncio.create_task(one()) for _ in range(50)]
        await asyncio.sleep(0)
        async with asyncio.timeout(1.0), places.place("anna", has_gone=never):
            pass
        free.set()
        await asyncio.wait_for(asyncio.gather(*impatient), 1.0)

    asyncio.run(served())


def test_who_gives_up_waiting_leaves_no_place_taken() -> None:
    async def left() -> None:
        places = RequestPlaces(1)
        async with places.place("first", has_gone=never):
            waiting = [
                asyncio.create_task(AsyncExitStack().enter_async_context(places.place("second", has_gone=never)))
                for _ in range(3)
            ]
            await asyncio.sleep(0)
            for one in waiting:
                one.cancel()
            await asyncio.gather(*waiting, return_exceptions=True)
        async with asyncio.timeout(1.0), places.place("third", has_gone=never):
            pass

    asyncio.run(left())


def test_what_nobody_waits_for_any_more_is_not_begun_and_takes_no_place() -> None:
    async def begun() -> list[str]:
        places, order, held = RequestPlaces(1), list[str](), AsyncExitStack()

        async def one(name: str, has_gone: Any) -> None:
            async with places.place("impatient", has_gone=has_gone):
                order.append(name)

        await held.enter_async_context(places.place("first", has_gone=never))
        waiting = [asyncio.create_task(one(name, gone)) for name, gone in (("a", always), ("b", never), ("c", always))]
        await asyncio.sleep(0)
        await held.aclose()
        outcomes = await asyncio.gather(*waiting, return_exceptions=True)
        assert [type(one) for one in outcomes] == [ClientDisconnected, type(None), ClientDisconnected]
        await one("d", always)  # it needs not wait: nobody looks
        return order

    assert asyncio.run(begun()) == ["b", "d"]


def test_a_turn_of_two_comes_in_that_of_either_and_costs_neither_another_one() -> None:
    async def served() -> list[str]:
        places, order, held = RequestPlaces(1), list[str](), AsyncExitStack()

        async def one(turn: "asyncio.Future[str]", name: str) -> None:
            who = await places.its_turn(turn)
            order.append(f"{name} for {who}")
            await asyncio.sleep(0)
            places.release(who)

        await held.enter_async_context(places.place("first", has_gone=never))
        many = [places.turn("impatient") for _ in range(3)]
        shared = places.turn("impatient")
        places.take_turns(shared, "anna")
        own = places.turn("anna")
        turns = [*((turn, str(number)) for number, turn in enumerate(many)), (shared, "shared"), (own, "own")]
        waiting = [asyncio.create_task(one(turn, name)) for turn, name in turns]
        await held.aclose()
        await asyncio.wait_for(asyncio.gather(*waiting), 1.0)
        return order

    assert asyncio.run(served()) == [
        "0 for impatient",
        "shared for anna",
        "1 for impatient",
        "own for anna",
        "2 for impatient",
    ]


def test_a_place_given_to_one_who_has_just_gone_goes_to_the_next() -> None:
    async def passed_on() -> None:
        places, held = RequestPlaces(1), AsyncExitStack()
        await held.enter_async_context(places.place("first", has_gone=never))
        gone = asyncio.create_task(AsyncExitStack().enter_async_context(places.place("gone", has_gone=never)))
        await asyncio.sleep(0)
        await held.aclose()
        gone.cancel()  # its turn has come, and it does not know yet
        await asyncio.gather(gone, return_exceptions=True)
        async with asyncio.timeout(1.0), places.place("next", has_gone=never):
            pass

    asyncio.run(passed_on())


def test_who_takes_an_answer_slowly_holds_no_connection(api: Api) -> None:
    held: list[int] = []

    async def watched(scope: Any, receive: Any, send: Any) -> None:
        async def told(message: Any) -> None:
            held.append(api.database.engine.pool.checkedout())  # type: ignore[attr-defined]
            await send(message)

        await api.app(scope, receive, told)

    async def ask() -> None:
        transport = httpx.ASGITransport(watched)
        async with httpx.AsyncClient(transport=transport, base_url="http://rundown") as client:
            assert (await client.get(f"{PREFIX}/machines/pump-7/samples")).status_code == 200

    asyncio.run(ask())
    assert held
    assert set(held) == {0}


def test_one_persons_many_changes_keep_another_persons_one_not_waiting(plant: Database) -> None:
    order: list[str] = []
    api = Api(plant, security=Security(required=True))
    with api.database.transaction() as session:
        keys = {
            who: api_keys.create(session, name=who, role=Role.OPERATOR, plants=None, days=1)[1]
            for who in ("impatient", "anna")
        }

    async def ask() -> None:
        current_default_thread_limiter().total_tokens = THREADS
        transport = httpx.ASGITransport(api.app)
        async with httpx.AsyncClient(transport=transport, base_url="http://rundown") as client:

            async def change(who: str) -> None:
                said = {"kind": "note", "at": "2026-01-01T00:00:00Z", "text": who, "by": who}
                headers = {"authorization": f"Bearer {keys[who]}"}
                answer = await client.post(f"{PREFIX}/machines/pump-7/timeline", json=said, headers=headers)
                assert answer.status_code == 201, answer.text
                order.append(who)

            impatient = [asyncio.create_task(change("impatient")) for _ in range(60)]
            while not order:
                await asyncio.sleep(0.001)
            await asyncio.gather(change("anna"), *impatient)

    asyncio.run(asyncio.wait_for(ask(), PATIENCE_S))
    assert order.index("anna") < 30
