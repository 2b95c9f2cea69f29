"""Pages of a list: each goes on behind the last row of the one before, in either direction, whatever was added since."""

import pytest
from sqlalchemy import delete, select
from sqlalchemy.orm import Session

from storage.database.engine import Database
from storage.paging import between, ordered
from storage.tables.operation import IdempotencyKeyRow

ROWS = [("a", 3), ("b", 1), ("c", 3), ("d", 2), ("e", 3)]
COLUMNS = (IdempotencyKeyRow.created_at, IdempotencyKeyRow.key)


def add(session: Session, key: str, created_at: int) -> None:
    session.add(IdempotencyKeyRow(key=key, fingerprint="", created_at=created_at, status=None, headers=None, body=None))
    session.flush()


def page(session: Session, after: tuple[int | str, ...] | None, *, descending: bool) -> list[IdempotencyKeyRow]:
    query = ordered(select(IdempotencyKeyRow), COLUMNS, after, descending=descending)
    return list(session.scalars(query.limit(2)))


@pytest.mark.parametrize("descending", [True, False])
def test_pages_hold_every_row_once_and_in_order(database: Database, descending: bool) -> None:
    with database.transaction() as session:
        for key, created_at in ROWS:
            add(session, key, created_at)
        expected = [key for _, key in sorted(((at, key) for key, at in ROWS), reverse=descending)]
        found: list[str] = []
        after: tuple[int | str, ...] | None = None
        while rows := page(session, after, descending=descending):
            found += [row.key for row in rows]
            after = rows[-1].created_at, rows[-1].key
        assert found == expected


def test_a_row_added_or_deleted_meanwhile_moves_no_other(database: Database) -> None:
    with database.transaction() as session:
        for key, created_at in ROWS:
            add(session, key, created_at)
        first = page(session, None, descending=True)
        after = first[-1].created_at, first[-1].key
        add(session, "f", 9)  # newer than all
        session.execute(delete(IdempotencyKeyRow).where(IdempotencyKeyRow.key == after[1]))
        assert [row.key for row in page(session, after, descending=True)] == ["a", "d"]


def test_limits_of_a_time_range_are_included(database: Database) -> None:
    with database.transaction() as session:
        for key, created_at in ROWS:
            add(session, key, created_at)

        def keys(first: int | None, last: int | None) -> list[str]:
            query = between(select(IdempotencyKeyRow), IdempotencyKeyRow.created_at, first, last)
            return sorted(row.key for row in session.scalars(query))

        assert keys(2, 3) == ["a", "c", "d", "e"]
        assert keys(None, 2) == ["b", "d"]
        assert keys(3, None) == ["a", "c", "e"]
        assert len(keys(None, None)) == len(ROWS)
