"""Backups of both kinds of database, made while others write, and what is refused before anything is lost."""

import json
import threading
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import select

from storage import backup, machines, quarantine
from storage.backup import BackupUnusable, described_by
from storage.claim import DatabaseUnusable
from storage.database import Database
from storage.quarantine import Rejection
from storage.tables import Base, QuarantineRow
from tests.databases import Databases, SqliteDatabases
from tests.plant import START, identification, machine, store_identification

REJECTION = Rejection(START, "key", None, "bad_frame", "detail", b"\0\xff")


@pytest.fixture
def target(databases: Databases, tmp_path: Path) -> str:
    """URL of a database that holds nothing."""
    return databases.new(tmp_path / "target.db")


@pytest.fixture
def told(plant: Database) -> Database:
    """A database with a bit of everything."""
    with plant.transaction() as session:
        store_identification(session, identification(), run_id=1)
        quarantine.add(session, [REJECTION])
    return plant


def contents(database: Database) -> dict[str, list[Any]]:
    with database.reading() as session:
        return {
            table.name: [tuple(row) for row in session.execute(select(table).order_by(*table.primary_key.columns))]
            for table in Base.metadata.sorted_tables
        }


def contents_of(url: str) -> dict[str, list[Any]]:
    database = Database(url)
    found = contents(database)
    database.close()
    return found


def test_a_backup_is_the_database_and_says_what_it_is(told: Database, target: str, tmp_path: Path) -> None:
    made = backup.back_up(told.url, tmp_path / "backup")
    assert made.kind == told.kind
    assert made.rows["machines"] == made.rows["identifications"] == made.rows["quarantine"] == 1
    assert backup.read(tmp_path / "backup") == made == backup.restore(target, tmp_path / "backup")
    assert contents_of(target) == contents(told)
    assert sorted(path.name for path in tmp_path.glob("backup*")) == ["backup", "backup.json"]


def test_what_was_restored_goes_on_counting(told: Database, target: str, tmp_path: Path) -> None:
    backup.back_up(told.url, tmp_path / "backup")
    backup.restore(target, tmp_path / "backup")
    restored = Database(target)
    with restored.transaction() as session:
        quarantine.add(session, [REJECTION])
    with restored.reading() as session:
        assert session.scalars(select(QuarantineRow.id).order_by(QuarantineRow.id)).all() == [1, 2]
    restored.close()


def test_a_backup_made_while_others_write_is_of_one_moment(told: Database, target: str, tmp_path: Path) -> None:
    """Each transaction adds as many entries as it counts: never is a part of one seen."""
    stop, written = threading.Event(), threading.Event()

    def write() -> None:
        while not stop.is_set():
            with told.transaction() as session:
                quarantine.add(session, [REJECTION] * 7)
            written.set()

    thread = threading.Thread(target=write)
    thread.start()
    try:
        for number in range(3):
            written.clear()
            assert written.wait(10)
            made = backup.back_up(told.url, tmp_path / f"backup{number}")
            assert made.rows["quarantine"] % 7 == 1
    finally:
        stop.set()
        thread.join(10)
    backup.restore(target, tmp_path / "backup2")
    restored = contents_of(target)
    assert restored["quarantine_counts"] == [("bad_frame", made.rows["quarantine"])]
    assert len(restored["quarantine"]) == made.rows["quarantine"]


def test_data_are_not_overwritten_unless_told(told: Database, databases: Databases, tmp_path: Path) -> None:
    backup.back_up(told.url, tmp_path / "backup")
    expected = contents(told)
    other = Database(databases.new(tmp_path / "other.db"))
    with other.transaction() as session:
        machines.create(session, machine(id="other"))
    before = contents(other)
    other.close()
    with pytest.raises(BackupUnusable, match=r"holds 2 rows: say --overwrite"):
        backup.restore(other.url, tmp_path / "backup")
    assert contents_of(other.url) == before
    backup.restore(other.url, tmp_path / "backup", overwrite=True)
    assert contents_of(other.url) == expected


def test_a_database_in_use_is_not_replaced(told: Database, tmp_path: Path) -> None:
    backup.back_up(told.url, tmp_path / "backup")
    told.claim()
    with pytest.raises(DatabaseUnusable, match="in use by another service"):
        backup.restore(told.url, tmp_path / "backup", overwrite=True)
    told.check()


def test_a_damaged_backup_is_refused(told: Database, target: str, tmp_path: Path) -> None:
    file = tmp_path / "backup"
    backup.back_up(told.url, file)
    held = bytearray(file.read_bytes())
    held[len(held) // 2] ^= 1
    file.write_bytes(held)
    with pytest.raises(BackupUnusable, match="is damaged: its SHA-256 is"):
        backup.restore(target, file)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"schema_revision": "9999"}, "schema revision 9999, which this release does not know"),
        ({"format": 2}, "a backup of format 2, not 1"),
        ({"kind": "oracle"}, "is a backup of oracle"),
    ],
)
def test_a_backup_of_something_else_is_refused(
    told: Database, target: str, tmp_path: Path, changes: dict[str, Any], said: str
) -> None:
    file = tmp_path / "backup"
    backup.back_up(told.url, file)
    description = json.loads(described_by(file).read_text())
    described_by(file).write_text(json.dumps(description | changes))
    with pytest.raises((BackupUnusable, DatabaseUnusable), match=said):
        backup.restore(target, file)


def test_a_backup_without_its_description_is_refused(told: Database, target: str, tmp_path: Path) -> None:
    file = tmp_path / "backup"
    backup.back_up(told.url, file)
    described_by(file).unlink()
    with pytest.raises(BackupUnusable, match=r"is no backup: .*backup\.json"):
        backup.restore(target, file)


def test_a_backup_never_replaces_another(told: Database, tmp_path: Path) -> None:
    backup.back_up(told.url, tmp_path / "backup")
    with pytest.raises(BackupUnusable, match="exists already"):
        backup.back_up(told.url, tmp_path / "backup")


def test_a_folder_that_is_not_there_is_said(told: Database, tmp_path: Path) -> None:
    with pytest.raises(BackupUnusable, match="cannot be written"):
        backup.back_up(told.url, tmp_path / "missing" / "backup")


def test_what_is_no_database_is_said(target: str, databases: Databases, tmp_path: Path) -> None:
    if isinstance(databases, SqliteDatabases):
        with pytest.raises(DatabaseUnusable, match="there is no database file"):
            backup.back_up(target, tmp_path / "backup")
        (tmp_path / "target.db").write_bytes(b"")
    with pytest.raises(DatabaseUnusable, match="holds no data of Rundown"):
        backup.back_up(target, tmp_path / "backup")
    assert list(tmp_path.glob("backup*")) == []
