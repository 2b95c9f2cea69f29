"""Marks of what is committed: they change with each commit to a table, whoever makes it."""

import sqlite3
import time
from collections.abc import Iterator
from pathlib import Path

import psutil
import pytest
from sqlalchemy import text, update

from storage.database import writer_turn
from storage.database.change_counts import WATCHED, WRITES, Changes
from storage.database.engine import Database
from storage.machines import machines
from storage.tables.machines import MachineRow
from tests.plant import START, identification, machine, sqlite_url, store_identification


@pytest.fixture
def file(tmp_path: Path) -> Iterator[Database]:
    """A new SQLite database."""
    one = Database(sqlite_url(tmp_path / "file.db"))
    yield one
    one.close()


def marked(changes: Changes, *tables: str) -> object:
    mark = changes.mark(tables or WATCHED)
    assert mark is not None
    return mark


def test_a_change_counts_when_it_is_committed(database: Database) -> None:
    changes = Changes(database)
    before = marked(changes)
    with database.transaction() as session:
        machines.create(session, machine())
        session.flush()
        assert marked(changes) == before or changes.waits  # PostgreSQL tells of what is under way, too
        session.rollback()
    with database.transaction() as session:
        machines.create(session, machine())
        during = marked(changes)
    assert marked(changes) not in (before, during)


def test_nothing_changes_while_nobody_writes(plant: Database) -> None:
    changes = Changes(plant)
    before = marked(changes)
    with plant.reading() as session:
        machines.get(session, "pump-7")
    assert marked(changes) == before


def test_repositories_change_the_marks(plant: Database) -> None:
    changes = Changes(plant)
    tables = "identifications", "estimates"
    before = marked(changes, *tables)
    with plant.transaction() as session:
        store_identification(session, identification({"coupling.C1.kxx": 1.0}), run_id=1, measured_at=START)
    assert marked(changes, *tables) != before


def test_every_commit_changes_the_mark(plant: Database) -> None:
    changes, seen = Changes(plant), set()
    for number in range(20):
        seen.add(marked(changes, "machines"))
        with plant.transaction() as session:
            session.execute(update(MachineRow).values(revision=number))
    assert len(seen) == 20


# --- SQLite: counts of each table -----------------------------------------------------------------------------------


def test_every_watched_table_has_its_triggers(file: Database) -> None:
    with file.reading() as session:
        found = session.scalars(text("SELECT name FROM sqlite_master WHERE type = 'trigger' AND name LIKE 'count_%'")).all()
    assert sorted(found) == sorted(f"count_{write.lower()}_{table}" for table in WATCHED for write in WRITES)


@pytest.mark.parametrize("table", WATCHED)
def test_every_kind_of_write_changes_the_mark_of_its_table_alone(file: Database, table: str, tmp_path: Path) -> None:
    changes = Changes(file)
    others = tuple(name for name in WATCHED if name != table)
    marked_others = marked(changes, *others)
    seen = {marked(changes, table)}
    other = sqlite3.connect(tmp_path / "file.db", isolation_level=None)  # as another process
    names = [row[1] for row in other.execute(f"PRAGMA table_info({table})")]
    other.execute(f"INSERT INTO {table} ({', '.join(names)}) VALUES ({', '.join('1' for _ in names)})")
    seen.add(marked(changes, table))
    other.execute(f"UPDATE {table} SET {names[-1]} = 2")
    seen.add(marked(changes, table))
    other.execute(f"DELETE FROM {table}")
    seen.add(marked(changes, table))
    other.close()
    assert len(seen) == 4
    assert marked(changes, *others) == marked_others


def test_a_store_that_is_locked_is_not_waited_for(file: Database, tmp_path: Path) -> None:
    file.close()
    other = sqlite3.connect(tmp_path / "file.db", isolation_level=None)
    other.execute("PRAGMA locking_mode = EXCLUSIVE")
    other.execute("UPDATE alerts SET severity = 1")
    began = time.monotonic()
    changes = Changes(file)
    assert changes.mark(("alerts",)) is None
    assert time.monotonic() - began < writer_turn.BUSY_TIMEOUT_MS / 1000 / 2
    other.close()
    assert changes.mark(("alerts",)) is not None


def test_with_the_database_its_connections_are_closed(file: Database, tmp_path: Path) -> None:
    several = [Changes(file), Changes(file)]
    assert len({marked(one) for one in several}) == 1
    assert open_files(tmp_path)
    file.close()
    assert open_files(tmp_path) == []


def open_files(folder: Path) -> list[str]:
    """Files of a folder that this process has open."""
    return [one.path for one in psutil.Process().open_files() if Path(one.path).parent == folder]
