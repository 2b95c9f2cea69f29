"""Rejected messages over a real database: counted for ever, kept for a while."""

import pytest
from sqlalchemy import func, select
from sqlalchemy.orm import Session

from storage.database.engine import Database
from storage.measurements import quarantine
from storage.measurements.quarantine import Rejection
from storage.tables.measurements import QuarantineRow
from tests.plant import (
    START,
)


def rejection(number: int, reason: str = "bad_frame", machine_id: str | None = None) -> Rejection:
    return Rejection(START + number, f"key/{number}", machine_id, reason, f"detail {number}", b"payload")


def kept(session: Session) -> list[int]:
    return [row.received_at - START for row in quarantine.newest(session, reason=None, machine_id=None, limit=100)]


def test_rejections_are_counted_by_reason(database: Database) -> None:
    with database.transaction() as session:
        quarantine.add(session, [rejection(1), rejection(2), rejection(3, "undecodable", "pump-7")])
    with database.transaction() as session:
        quarantine.add(session, [rejection(4)])
    with database.reading() as session:
        assert quarantine.counts(session) == {"bad_frame": 3, "undecodable": 1}
        assert kept(session) == [4, 3, 2, 1]
        by_reason = quarantine.newest(session, reason="bad_frame", machine_id=None, limit=2)
        assert [row.received_at - START for row in by_reason] == [4, 2]
        by_machine = quarantine.newest(session, reason=None, machine_id="pump-7", limit=9)
        assert [row.detail for row in by_machine] == ["detail 3"]


def test_the_oldest_rejections_are_let_go_but_stay_counted(database: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(quarantine, "KEPT_ROWS", 3)
    with database.transaction() as session:
        quarantine.add(session, [rejection(number) for number in range(5)])
        assert kept(session) == [4, 3, 2]
        quarantine.add(session, [rejection(5)])
        assert kept(session) == [5, 4, 3]
        assert quarantine.counts(session) == {"bad_frame": 6}


def test_of_a_large_rejection_only_the_beginning_is_kept(database: Database) -> None:
    large = Rejection(START, "k" * 2000, None, "too_large", "d" * 9000, b"x" * 100_000)
    with database.transaction() as session:
        quarantine.add(session, [large])
    with database.reading() as session:
        (row,) = quarantine.newest(session, reason=None, machine_id=None, limit=9)
        assert (row.size, len(row.payload), len(row.key), len(row.detail)) == (100_000, quarantine.KEPT_BYTES, 512, 2000)


def test_nothing_rejected_changes_nothing(database: Database) -> None:
    with database.transaction() as session:
        quarantine.add(session, [])
        assert quarantine.counts(session) == {}
        assert session.scalar(select(func.count()).select_from(QuarantineRow)) == 0
