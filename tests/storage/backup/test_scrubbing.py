"""Tests that what was deleted from an SQLite file is not left in it, or it is said why; looking into a store changes no
file."""

import sqlite3
from contextlib import closing
from pathlib import Path

import pytest
from sqlalchemy import text

from storage.alerts import deliveries
from storage.backup import scrubbing
from storage.backup.scrubbing import ScrubFailed, overwrite_deleted, scrub
from storage.database.claim import DatabaseUnusable
from storage.database.engine import Database
from storage.database.read_only import read_only_session
from storage.operation import api_keys
from tests.conftest import Stores
from tests.plant import sqlite_url

MARK = "deleted and to be gone"


@pytest.fixture
def path(stores: Stores, tmp_path: Path) -> Path:
    """A store in which something was deleted."""
    path = tmp_path / "rundown.db"
    url = stores.databases("sqlite").copy(stores.empty("sqlite"), path)
    with closing(Database(url)) as database, database.transaction() as session:
        session.connection().exec_driver_sql("PRAGMA secure_delete = OFF")
        number = deliveries.subscribe(session, kind="email", name=MARK, target="a@b.example", secret=None).id
        session.execute(text("DELETE FROM subscriptions WHERE id = :number"), {"number": number})
    assert MARK.encode() in path.read_bytes()
    return path


def test_a_file_is_written_again_without_what_was_deleted(path: Path) -> None:
    with closing(Database(sqlite_url(path))) as database:
        scrub(database)
        assert MARK.encode() not in path.read_bytes()
        with database.transaction() as session:
            deliveries.subscribe(session, kind="email", name="x", target="a@b.example", secret=None)


def test_of_a_large_file_and_of_one_that_is_read_it_is_said_what_to_do(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with closing(Database(sqlite_url(path))) as database, closing(sqlite3.connect(path, isolation_level=None)) as reader:
        with monkeypatch.context() as patched:
            patched.setattr(scrubbing, "LARGEST", 1)
            with pytest.raises(ScrubFailed, match=r"too large .*: stop the service and run: sqlite3 .* VACUUM"):
                scrub(database)
        monkeypatch.setattr("storage.database.writer_turn.BUSY_TIMEOUT_MS", 100)
        reader.execute("BEGIN")
        reader.execute("SELECT count(*) FROM subscriptions").fetchall()
        with pytest.raises(ScrubFailed, match="another program reads"):
            scrub(database)


def test_what_a_session_replaces_is_overwritten(path: Path) -> None:
    with closing(Database(sqlite_url(path))) as database:
        with database.transaction() as session:
            row = deliveries.subscribe(session, kind="email", name="x", target="first@b.example", secret=None)
        with database.transaction() as session:
            overwrite_deleted(session)
            deliveries.get(session, row.id).target = "second@b.example"
    assert b"first@b.example" not in path.read_bytes()


def test_looking_changes_no_file_and_makes_none(path: Path, tmp_path: Path) -> None:
    """Neither of a store that nobody uses, nor of one in use, nor of one whose log was deleted under its service."""

    def files() -> dict[str, bytes]:
        return {one.name: one.read_bytes() for one in path.parent.iterdir() if one.suffix != ".db-shm"}

    def looked() -> int:
        before = files()
        with read_only_session(sqlite_url(path)) as session:
            assert not api_keys.any_exist(session)
            count = session.scalar(text("SELECT count(*) FROM subscriptions"))
        with pytest.raises(DatabaseUnusable, match="readonly"), read_only_session(sqlite_url(path)) as session:
            session.execute(text("DELETE FROM subscriptions"))
        assert files() == before
        return int(count or 0)

    assert looked() == 0
    with closing(Database(sqlite_url(path))) as database:
        with database.transaction() as session:
            deliveries.subscribe(session, kind="email", name="x", target="a@b.example", secret=None)
        assert looked() == 1
        path.with_name("rundown.db-wal").unlink()
        assert looked() == 0
    with closing(Database(sqlite_url(path))) as database, database.reading() as session:
        assert len(deliveries.list_subscriptions(session)) == 1
    with (
        pytest.raises(DatabaseUnusable, match="unable to open"),
        read_only_session(sqlite_url(tmp_path / "none.db")) as session,
    ):
        api_keys.any_exist(session)
    assert not (tmp_path / "none.db").exists()
