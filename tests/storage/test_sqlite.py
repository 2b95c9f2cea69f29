"""What holds of SQLite only: files that are none or gone, locks of other processes, and when a transaction is on the disk."""

import sqlite3
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from storage import machines
from storage.claim import DatabaseUnusable
from storage.database import Database
from tests.databases import SqliteDatabases
from tests.plant import machine, sqlite_url


@pytest.fixture
def database(tmp_path: Path) -> Iterator[Database]:
    """A new file."""
    one = Database(sqlite_url(tmp_path / "rundown.db"))
    yield one
    one.close()


@pytest.fixture
def plant(database: Database) -> Database:
    """With the machine of `tests.plant`."""
    with database.transaction() as session:
        machines.create(session, machine())
    return database


def test_a_new_database_on_which_another_process_works_is_waited_for(tmp_path: Path) -> None:
    other = sqlite3.connect(tmp_path / "new.db", isolation_level=None, check_same_thread=False)
    other.execute("PRAGMA journal_mode = WAL")
    other.execute("BEGIN IMMEDIATE")
    other.execute("CREATE TABLE theirs (id INTEGER)")
    release = threading.Timer(0.3, other.commit)
    release.start()
    try:
        Database(sqlite_url(tmp_path / "new.db")).close()
    finally:
        release.join(5)
        other.close()


def test_a_directory_is_no_database(tmp_path: Path) -> None:
    with pytest.raises(DatabaseUnusable, match=r"database sqlite:///.* cannot be used: unable to open database file"):
        Database(sqlite_url(tmp_path))


def test_a_missing_folder_is_said(tmp_path: Path) -> None:
    with pytest.raises(DatabaseUnusable, match="unable to open database file"):
        Database(sqlite_url(tmp_path / "missing" / "rundown.db"))


def test_another_file_is_no_database_and_stays_as_it_is(tmp_path: Path) -> None:
    path = tmp_path / "letter.txt"
    path.write_text("Dear Sir or Madam, " * 100)
    with pytest.raises(DatabaseUnusable, match=r"letter\.txt cannot be used: file is not a database"):
        Database(sqlite_url(path))
    assert path.read_text() == "Dear Sir or Madam, " * 100


def test_check_says_when_the_database_is_gone(database: Database) -> None:
    database.check()
    database.close()
    SqliteDatabases().take_away(database.url)
    with pytest.raises(DatabaseUnusable, match="was deleted or replaced"):
        database.check()


def test_samples_are_durable_before_they_count_as_received(database: Database) -> None:
    with database.engine.connect() as connection:
        assert connection.exec_driver_sql("PRAGMA journal_mode").scalar() == "wal"
        assert connection.exec_driver_sql("PRAGMA synchronous").scalar() == 2  # FULL


def test_another_process_s_lock_is_waited_for(plant: Database, tmp_path: Path) -> None:
    other = sqlite3.connect(tmp_path / "rundown.db", isolation_level=None, check_same_thread=False)
    other.execute("BEGIN IMMEDIATE")
    release = threading.Timer(0.2, other.rollback)
    release.start()
    with plant.transaction() as session:
        machines.create(session, machine(id="other"))
    release.join(5)
    other.close()
    with plant.reading() as session:
        assert len(machines.every(session)) == 2
