"""Tests what somebody without a role makes the store write: nothing, or so much and no more."""

import asyncio
from collections.abc import Callable

import pytest
from sqlalchemy import func, select

from service.security import repeated_entries
from service.security.repeated_entries import MINUTE_S, RepeatedEntries
from storage.database.engine import Database
from storage.operation import audit
from storage.operation.audit import AuditedOperation
from storage.tables.operation import IdempotencyKeyRow
from tests.api_in_process import PREFIX, Api, problem
from tests.plant import KEY
from tests.service.security.conftest import Clock, Filled, bearer

NOTES = f"{PREFIX}/machines/{KEY.machine}/timeline"


def idempotency_keys(database: Database) -> int:
    with database.reading() as session:
        return session.scalar(select(func.count()).select_from(IdempotencyKeyRow)) or 0


@pytest.mark.parametrize("path", ["/logout", "/login", "/login/callback", "/nothing", NOTES])
@pytest.mark.parametrize("key", [None, "viewer"])
def test_no_idempotency_key_is_kept_for_who_may_change_nothing(api: Api, filled: Filled, path: str, key: str | None) -> None:
    for number in range(3):
        headers = bearer(filled.keys[key]) if key else {}
        api.ask("POST", path, headers=headers | {"Idempotency-Key": f"new-{number}"})
    assert idempotency_keys(api.database) == 0


def trail(database: Database) -> list[tuple[str, str, str]]:
    """Who, from where and the outcome, oldest first."""
    with database.reading() as session:
        assert audit.verify(session) == []
        return [(row.who, row.address, row.outcome) for row in reversed(audit.newest(session, limit=1000))]


def viewer_asks(api: Api, filled: Filled) -> None:
    problem(api.ask("POST", NOTES, headers=bearer(filled.keys["viewer"])), 403)


def anonymous_page_asks(api: Api, _filled: Filled) -> None:
    problem(api.ask("POST", "/logout", headers={"Origin": "https://evil.example"}), 403)


def wrong_key_logs_in(api: Api, _filled: Filled) -> None:
    assert api.ask("POST", "/login", data={"key": "wrong"}).status_code == 401


def viewer_logs_in(api: Api, filled: Filled) -> None:
    assert api.ask("POST", "/login", data={"key": filled.keys["viewer"]}).status_code == 303
    api.http.cookies.clear()


@pytest.mark.parametrize("attack", [viewer_asks, anonymous_page_asks, wrong_key_logs_in, viewer_logs_in])
def test_a_flood_is_one_entry_a_minute_in_the_audit_trail(
    api: Api, filled: Filled, attack: Callable[[Api, Filled], None]
) -> None:
    before = len(trail(api.database))
    for _ in range(20):
        attack(api, filled)
    assert len(trail(api.database)) == before + 1
    api.app.state.repeated.write(everything=True)
    first, counted = trail(api.database)[before:]
    assert counted == (*first[:2], f"{first[2]}: 19 more within a minute")


def entry(who: str = "anna", operation: str = "set_limits", address: str = "10.0.0.1") -> AuditedOperation:
    return AuditedOperation(who, address, operation, "POST /there", "refused")


def test_repeated_entries_are_told_when_their_minute_is_over(database: Database) -> None:
    clock = Clock()
    repeated = RepeatedEntries(database, clock=clock)
    assert repeated.first(entry())
    assert repeated.first(entry(who="berta"))
    assert repeated.first(entry(operation="subscribe"))
    assert not any(repeated.first(entry(address=f"10.0.0.{number % 3}")) for number in range(134))
    repeated.write()
    assert trail(database) == []
    clock.now += MINUTE_S
    assert not repeated.first(entry())
    repeated.write()
    assert trail(database) == [("anna", "3 addresses", "refused: 135 more within a minute")]
    assert not repeated.first(entry())  # that one was the entry of the minute that began
    clock.now += MINUTE_S
    repeated.write()
    assert trail(database)[1:] == [("anna", "10.0.0.1", "refused: 1 more within a minute")]
    clock.now += MINUTE_S
    repeated.write()
    assert repeated.first(entry())
    assert len(trail(database)) == 2


def test_so_many_principals_are_counted_apart(database: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(repeated_entries, "MAXIMUM_COUNTS", 3)
    monkeypatch.setattr(repeated_entries, "MAXIMUM_ADDRESSES", 2)
    repeated = RepeatedEntries(database)
    assert sum(repeated.first(entry(who=f"person {number}", address=f"10.0.0.{number}")) for number in range(100)) == 4
    repeated.write(everything=True)
    assert trail(database) == [("many", "2 or more addresses", "refused: 96 more within a minute")]


def test_what_was_counted_is_written_at_a_clean_stop(database: Database) -> None:
    repeated = RepeatedEntries(database)

    async def served() -> None:
        async with repeated.regular_writing():
            assert [repeated.first(entry()) for _ in range(3)] == [True, False, False]

    asyncio.run(served())
    assert trail(database) == [("anna", "10.0.0.1", "refused: 2 more within a minute")]
