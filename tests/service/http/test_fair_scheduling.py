"""Slow requests that come at once begin one by one, clients in turn; who asks whether the service is alive waits for none."""

import asyncio
import concurrent.futures
import time
from collections.abc import Callable, Collection, Coroutine
from typing import Any

from starlette.types import Message, Receive, Scope, Send

from service.http.fair_scheduling import AT_ONCE_S, MOST_LET_IN, PERSON, FairScheduling, RecentCredentials

Ask = Callable[[Scope], Coroutine[Any, Any, None]]


def asked(client: str, path: str = "/machines", *, key: bytes = b"one") -> Scope:
    return {"type": "http", "path": path, "client": (client, 50_000), "headers": [(b"authorization", key)]}


async def receive() -> Message:
    raise AssertionError


async def send(_message: Message) -> None:
    raise AssertionError


def begun(
    attack: Callable[[Ask], Coroutine[Any, Any, None]],
    *,
    holding_s: float = 2 * AT_ONCE_S,
    let_in: Collection[bytes] = (),
) -> list[Scope]:
    """The requests of an attack in the order in which they began; each holds the event loop for so long.

    let_in: credentials that are accepted, each another person's.
    """
    order: list[Scope] = []

    async def app(scope: Scope, _receive: Receive, _send: Send) -> None:
        order.append(scope)
        key = scope["headers"][0][1]
        scope["state"] = {PERSON: key.decode() if key in let_in else ""}
        time.sleep(holding_s)

    one = FairScheduling(app, at_once={"/alive"})
    asyncio.run(_run(attack(lambda scope: one(scope, receive, send))))
    return order


async def _run(one: Coroutine[Any, Any, None]) -> None:
    await asyncio.wait_for(one, 20)


def most_between(*, holding_s: float) -> int:
    """Return how many of 40 requests began at most before others were served."""
    between = list[int]()

    async def attack(ask: Ask) -> None:
        began = 0

        async def counted(scope: Scope) -> None:
            nonlocal began
            await ask(scope)
            began += 1

        async with asyncio.TaskGroup() as group:
            for _ in range(40):
                group.create_task(counted(asked("10.0.0.1")))
            before = 0
            while before < 40:
                await asyncio.sleep(0)
                between.append(began - before)
                before = began

    assert len(begun(attack, holding_s=holding_s)) == 40
    return max(between)


def test_others_are_served_between_two_of_many_that_came_at_once() -> None:
    assert most_between(holding_s=2 * AT_ONCE_S) == 1


def test_quick_ones_begin_together() -> None:
    assert max(most_between(holding_s=0.0) for _ in range(5)) > 1


def test_clients_take_turns_and_life_is_reported_at_once() -> None:
    async def attack(ask: Ask) -> None:
        async with asyncio.TaskGroup() as group:
            for _ in range(40):
                group.create_task(ask(asked("10.0.0.1")))
            group.create_task(ask(asked("10.0.0.2")))
            group.create_task(ask(asked("10.0.0.3", "/alive")))

    clients = [scope["client"][0] for scope in begun(attack)]
    assert len(clients) == 42
    assert clients.index("10.0.0.3") == 1, "behind the one that had begun"
    assert clients.index("10.0.0.2") <= 3, "though 39 of another client came before"


def test_people_behind_one_proxy_take_turns_and_keys_that_are_made_up_cost_nobody_else_a_turn() -> None:
    async def attack(ask: Ask) -> None:
        for key in (b"one", b"another"):
            await ask(asked("10.0.0.1", key=key))  # both are let in before the others come
        async with asyncio.TaskGroup() as group:
            for number in range(40):
                group.create_task(ask(asked("10.0.0.1", key=b"made up %d" % number)))
            for _ in range(12):
                group.create_task(ask(asked("10.0.0.1")))
            group.create_task(ask(asked("10.0.0.1", key=b"another")))
            group.create_task(ask(asked("10.0.0.3")))

    order = [(scope["client"][0], scope["headers"][0][1]) for scope in begun(attack, let_in={b"one", b"another"})][2:]
    assert len(order) == 54
    assert order.index(("10.0.0.1", b"another")) <= 7, "though 51 of the same address came before"
    assert order.index(("10.0.0.3", b"one")) <= 4, "though 53 of another address came before"
    own = [place for place, one in enumerate(order) if one == ("10.0.0.1", b"one")]
    assert max(own) <= 12 * 3 + 2, "though 40 made-up keys of the same address came before"


def let_in(key: bytes, person: str) -> Scope:
    return {**asked("10.0.0.1", key=key), "state": {PERSON: person}}


def test_credentials_of_whom_nobody_let_in_lately_are_forgotten() -> None:
    people = RecentCredentials()
    for number in range(MOST_LET_IN + 1):
        people.record(let_in(b"%d" % number, f"person {number}"))
    assert people.person(asked("10.0.0.1", key=b"0")) == ""
    assert people.person(asked("10.0.0.2", key=b"1")) == "person 1"
    people.record(let_in(b"made up", ""))
    assert people.person(asked("10.0.0.1", key=b"made up")) == ""


def test_who_goes_away_while_waiting_holds_up_nobody() -> None:
    async def attack(ask: Ask) -> None:
        async with asyncio.TaskGroup() as group:
            tasks: list[asyncio.Task[None]] = [group.create_task(ask(asked("10.0.0.1"))) for _ in range(20)]
            await asyncio.sleep(0)
            for task in tasks[1:19]:
                task.cancel()
        await ask(asked("10.0.0.2"))

    assert [scope["client"][0] for scope in begun(attack)] == ["10.0.0.1", "10.0.0.1", "10.0.0.2"]


def test_requests_of_two_loops_do_not_wait_for_each_other() -> None:
    """A turn that the other loop has to give would never come."""
    order: list[Scope] = []

    async def app(scope: Scope, _receive: Receive, _send: Send) -> None:
        order.append(scope)

    one = FairScheduling(app)

    async def requests() -> None:
        for _ in range(50):
            await asyncio.gather(*(one(asked("10.0.0.1"), receive, send) for _ in range(4)))

    with concurrent.futures.ThreadPoolExecutor(8) as threads:
        for done in [threads.submit(asyncio.run, _run(requests())) for _ in range(8)]:
            done.result(timeout=60)
    assert len(order) == 8 * 50 * 4
