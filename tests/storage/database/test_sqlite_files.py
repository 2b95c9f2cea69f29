"""A file of an SQLite store is deleted or replaced while it is open: nothing committed is lost, nothing more is taken."""

import shutil
import sqlite3
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from sqlalchemy.exc import OperationalError

from storage.database.change_counts import WATCHED, Changes
from storage.database.claim import DatabaseUnusable
from storage.database.engine import Database
from storage.database.plant_scope import PlantScope
from storage.machines import machines
from tests.plant import machine, sqlite_url


@pytest.fixture
def database(tmp_path: Path) -> Iterator[Database]:
    """A new file, with a machine that stands in the log only."""
    one = Database(sqlite_url(tmp_path / "rundown.db"))
    with one.engine.connect() as connection:
        connection.exec_driver_sql("PRAGMA wal_checkpoint(TRUNCATE)")
    add(one, "first")
    yield one
    one.close()


def add(database: Database, name: str) -> None:
    with database.transaction() as session:
        machines.create(session, machine(id=name))


def in_the_file_alone(folder: Path) -> list[str]:
    """What somebody finds who has nothing but the main file: as after a kill. Copied by another process: to open and close
    the file in this one would take SQLite's locks from it.
    """
    copy = folder / "alone" / "rundown.db"
    copy.parent.mkdir(exist_ok=True)
    subprocess.run(["cp", str(folder / "rundown.db"), str(copy)], check=True)
    script = f"import sqlite3; print(*(row[0] for row in sqlite3.connect({str(copy)!r}).execute('SELECT id FROM machines')))"
    return subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout.split()


def replaced(file: Path) -> None:
    """By a copy of it."""
    shutil.copy(file, file.with_name("copy"))
    file.with_name("copy").replace(file)


@pytest.mark.parametrize("befalls", [Path.unlink, replaced])
@pytest.mark.parametrize("end", ["-wal", "-shm"])
def test_what_was_committed_is_saved_before_it_is_said(
    database: Database, tmp_path: Path, end: str, befalls: Callable[[Path], None]
) -> None:
    assert in_the_file_alone(tmp_path) == []
    befalls(tmp_path / f"rundown.db{end}")
    with pytest.raises(DatabaseUnusable, match=rf"rundown\.db{end} was deleted or replaced .* is saved in .*: restart"):
        database.check()
    assert in_the_file_alone(tmp_path) == ["first"]
    assert database.needs_restart


def test_a_commit_to_a_log_that_is_gone_is_saved_before_it_counts(database: Database, tmp_path: Path) -> None:
    with database.transaction() as session:
        machines.create(session, machine(id="second"))
        (tmp_path / "rundown.db-wal").unlink()
    assert in_the_file_alone(tmp_path) == ["first", "second"]


@pytest.mark.parametrize("narrow", [False, True])
def test_nothing_more_is_taken(database: Database, tmp_path: Path, narrow: bool) -> None:
    (tmp_path / "rundown.db-wal").unlink()
    store = PlantScope(database, frozenset({"plant-1"})) if narrow else database
    with pytest.raises(OperationalError, match="was deleted or replaced"), store.transaction():
        pass
    with database.reading() as session:  # by a connection that is open
        assert machines.list_ids(session) == ["first"]


def test_no_connection_makes_a_second_log(database: Database, tmp_path: Path) -> None:
    """What it wrote would not fit the index that those share which are open."""
    with database.engine.connect():
        (tmp_path / "rundown.db-wal").unlink()
        with pytest.raises(OperationalError, match="was deleted or replaced"):
            database.engine.connect()
        with pytest.raises(OperationalError, match="was deleted or replaced"):
            Changes(database).mark(WATCHED)
    assert not (tmp_path / "rundown.db-wal").exists()


def test_while_a_reader_hinders_it_is_said_that_not_all_is_saved(database: Database, tmp_path: Path) -> None:
    with database.reading() as reading:
        assert machines.list_ids(reading) == ["first"]
        add(database, "second")
        (tmp_path / "rundown.db-wal").unlink()
        with pytest.raises(DatabaseUnusable, match=r"not saved yet\. Stop the service cleanly"):
            database.check()
        assert not database.needs_restart
    with pytest.raises(DatabaseUnusable, match="is saved in"):
        database.check()
    assert in_the_file_alone(tmp_path) == ["first", "second"]


def test_a_clean_end_saves_all_though_nobody_has_looked(database: Database, tmp_path: Path) -> None:
    for end in ("-wal", "-shm"):
        (tmp_path / f"rundown.db{end}").unlink()
    database.close()
    again = Database(database.url)
    with again.reading() as session:
        assert machines.list_ids(session) == ["first"]
    again.close()


def test_a_main_file_that_was_replaced_takes_nothing(database: Database, tmp_path: Path) -> None:
    replaced(tmp_path / "rundown.db")
    with pytest.raises(OperationalError, match=r"the database file .* was deleted or replaced .*: restart the service"):
        add(database, "second")


def test_a_store_that_nobody_touches_is_whole(database: Database) -> None:
    database.check()
    add(database, "second")
    assert not database.needs_restart
    with sqlite3.connect(database.engine.url.database or "") as other:
        assert other.execute("SELECT count(*) FROM machines").fetchone() == (2,)
    other.close()
    add(database, "third")
    database.check()
