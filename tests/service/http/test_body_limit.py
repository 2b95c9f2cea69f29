"""Bodies that are parsed on the event loop: one at a time, with others in between."""

import asyncio
import time

from starlette.types import Message, Receive, Scope, Send

from service.http.body_limit import IN_TURN, BodyLimit

PARSING_S = 0.02


def parsed_between_others(size: int, number: int) -> list[int]:
    """Return how many bodies of a size, that came all at once, are parsed between two moments in which somebody else is
    served."""
    parsed, between = list[float](), list[int]()

    async def parsing(_scope: Scope, receive: Receive, _send: Send) -> None:
        assert (await receive())["more_body"] is False
        parsed.append(time.monotonic())
        time.sleep(PARSING_S)  # as a parser does, which holds the loop

    async def receive() -> Message:
        return {"type": "http.request", "body": bytes(size), "more_body": False}

    async def send(_message: Message) -> None:
        raise AssertionError

    async def others() -> None:
        served = 0
        while served < number:
            await asyncio.sleep(0)
            between.append(len(parsed) - served)
            served = len(parsed)

    async def attack() -> None:
        limit, scope = BodyLimit(parsing), {"type": "http", "headers": []}
        async with asyncio.TaskGroup() as group:
            for _ in range(number):
                group.create_task(limit(scope, receive, send))
            group.create_task(others())

    asyncio.run(attack())
    assert len(parsed) == number
    return between


def test_large_bodies_are_parsed_in_turn_and_others_served_in_between() -> None:
    between = parsed_between_others(IN_TURN, 10)
    assert max(between) == 1
    assert between.count(0) > 10  # others have as much of the time


def test_a_small_one_waits_for_nobody() -> None:
    assert max(parsed_between_others(IN_TURN - 1, 10)) == 10
