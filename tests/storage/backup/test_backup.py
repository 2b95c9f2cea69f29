"""Backups of both kinds of database, made while others write, and what is refused before anything is lost."""

import errno
import json
import os
import sqlite3
import threading
from contextlib import closing
from datetime import datetime
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import select

from storage.backup import backup, backup_file, sqlite_copy
from storage.backup.backup_file import BackupUnusable, description_path
from storage.database.claim import DatabaseUnusable
from storage.database.engine import Database
from storage.machines import machines
from storage.measurements import quarantine
from storage.measurements.quarantine import Rejection
from storage.tables.base import Base
from storage.tables.measurements import QuarantineRow
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


def test_the_newest_backup_of_a_folder_is_a_complete_one(told: Database, tmp_path: Path) -> None:
    folder = tmp_path / "backups"
    folder.mkdir()
    assert backup_file.newest_in(folder) is None
    (folder / "notes.json").write_text("{}")
    (folder / "notes").touch()
    first = backup.back_up(told.url, folder / "monday")
    assert str(backup_file.newest_in(folder)) == str(datetime.fromisoformat(first.made_at))
    backup.back_up(told.url, folder / "cut off")
    os.truncate(folder / "cut off", 10)
    assert str(backup_file.newest_in(folder)) == str(datetime.fromisoformat(first.made_at))
    (folder / "monday").unlink()
    assert backup_file.newest_in(folder) is None
    with pytest.raises(FileNotFoundError):
        backup_file.newest_in(tmp_path / "nowhere")


def test_a_backup_is_the_database_and_says_what_it_is(told: Database, target: str, tmp_path: Path) -> None:
    made = backup.back_up(told.url, tmp_path / "backup")
    assert made.kind == told.kind
    assert made.rows["machines"] == made.rows["identifications"] == made.rows["quarantine"] == 1
    assert backup_file.read(tmp_path / "backup") == made == backup.restore(target, tmp_path / "backup").backup
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


def test_what_is_written_between_two_steps_is_not_in_the_backup(
    told: Database, target: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if told.kind != "sqlite":
        pytest.skip("a dump is of one snapshot, and has no steps")
    monkeypatch.setattr(sqlite_copy, "_PAGES_AT_ONCE", 5)
    reported: list[tuple[int, int]] = []

    def write_meanwhile(done: int, total: int) -> None:
        reported.append((done, total))
        with told.transaction() as session:
            quarantine.add(session, [REJECTION] * 7)

    made = backup.back_up(told.url, tmp_path / "backup", write_meanwhile)
    assert len(reported) > 3
    assert reported == sorted(reported)
    assert reported[-1][0] == reported[-1][1]
    assert made.rows["quarantine"] == 1
    assert len(contents(told)["quarantine"]) == 1 + 7 * len(reported)
    copied: list[tuple[int, int]] = []
    backup.restore(target, tmp_path / "backup", lambda done, total: copied.append((done, total)))
    assert copied[-1] == (made.size, made.size)
    assert len(contents_of(target)["quarantine"]) == 1


def test_backups_of_postgresql_say_how_far_they_are(told: Database, target: str, tmp_path: Path) -> None:
    if told.kind != "postgresql":
        pytest.skip("of SQLite by pages, in the test above")
    made_of: list[tuple[int, int]] = []
    restored: list[tuple[int, int]] = []
    made = backup.back_up(told.url, tmp_path / "backup", lambda done, total: made_of.append((done, total)))
    backup.restore(target, tmp_path / "backup", lambda done, total: restored.append((done, total)))
    total = sum(made.rows.values())
    for reported in (made_of, restored):
        assert {one for _, one in reported} == {total}
        assert reported == sorted(reported)
        assert reported[0][0] == 0
        assert 0.5 * total <= reported[-1][0] <= total


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
    description = json.loads(description_path(file).read_text())
    description_path(file).write_text(json.dumps(description | changes))
    with pytest.raises((BackupUnusable, DatabaseUnusable), match=said):
        backup.restore(target, file)


def test_a_backup_without_its_description_is_refused(told: Database, target: str, tmp_path: Path) -> None:
    file = tmp_path / "backup"
    backup.back_up(told.url, file)
    description_path(file).unlink()
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


@pytest.fixture
def file_only(databases: Databases) -> None:
    """Skip the test but on SQLite, whose logs lie beside its file."""
    if not isinstance(databases, SqliteDatabases):
        pytest.skip("PostgreSQL keeps its log to itself")


def killed_writer(told: Database, path: Path, *, checkpointed: bool) -> None:
    """Return what a writer leaves that was killed behind what `told` holds: a file, and a log that only in part is in it."""
    with told.engine.connect() as connection:
        connection.exec_driver_sql("PRAGMA wal_checkpoint(TRUNCATE)")
        connection.exec_driver_sql("PRAGMA wal_autocheckpoint = 0")
    with told.transaction() as session:
        for number in range(30):
            machines.create(session, machine(id=f"later-{number}"))
    if checkpointed:
        with told.engine.connect() as connection:
            connection.exec_driver_sql("PRAGMA wal_checkpoint(PASSIVE)")
        with told.transaction() as session:
            machines.create(session, machine(id="last"))
    source = Path(told.engine.url.database or "")
    for end in ("", "-wal"):
        path.with_name(path.name + end).write_bytes(source.with_name(source.name + end).read_bytes())


@pytest.mark.parametrize("checkpointed", [False, True])
@pytest.mark.usefixtures("file_only")
def test_a_log_that_was_left_behind_is_not_played_into_what_is_restored(
    told: Database, target: str, tmp_path: Path, checkpointed: bool
) -> None:
    """Its database is gone, the log of a service that was killed is not."""
    backup.back_up(told.url, tmp_path / "backup")
    expected = contents(told)
    path = tmp_path / "target.db"
    killed_writer(told, path, checkpointed=checkpointed)
    path.unlink()
    path.with_name("target.db-journal").write_bytes(b"left")
    backup.restore(target, tmp_path / "backup")
    assert contents_of(target) == expected
    assert [one.name for one in tmp_path.glob("target.db*")] == ["target.db"]


@pytest.mark.parametrize("logged", [False, True])
@pytest.mark.usefixtures("file_only")
def test_a_damaged_database_is_replaced(told: Database, target: str, tmp_path: Path, logged: bool) -> None:
    """A restore is needed for just that."""
    backup.back_up(told.url, tmp_path / "backup")
    expected = contents(told)
    path = tmp_path / "target.db"
    killed_writer(told, path, checkpointed=True)
    if not logged:
        path.with_name("target.db-wal").unlink()
    with path.open("r+b") as opened:
        opened.write(b"no database" * 500)
    if not logged:
        with pytest.raises(BackupUnusable, match=r"is damaged \(file is not a database\): say --overwrite"):
            backup.restore(target, tmp_path / "backup")
    backup.restore(target, tmp_path / "backup", overwrite=True)
    assert contents_of(target) == expected


@pytest.mark.usefixtures("file_only")
def test_an_old_database_is_whole_until_the_new_one_is_there(
    told: Database, target: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A restore that dies at the last step leaves it, with what only its log held."""
    backup.back_up(told.url, tmp_path / "backup")
    killed_writer(told, tmp_path / "target.db", checkpointed=True)
    expected = contents(told)

    def dies(*_: object) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(Path, "replace", dies)
        with pytest.raises(KeyboardInterrupt):
            backup.restore(target, tmp_path / "backup", overwrite=True)
    assert contents_of(target) == expected


@pytest.mark.usefixtures("file_only")
def test_a_database_that_somebody_reads_is_not_replaced(told: Database, target: str, tmp_path: Path) -> None:
    """A program that knows nothing of the claim."""
    backup.back_up(told.url, tmp_path / "backup")
    killed_writer(told, tmp_path / "target.db", checkpointed=False)
    expected = contents(told)
    with closing(sqlite3.connect(tmp_path / "target.db")) as reader:
        reader.execute("BEGIN")
        reader.execute("SELECT count(*) FROM machines").fetchall()
        with pytest.raises(BackupUnusable, match="database is locked"):
            backup.restore(target, tmp_path / "backup", overwrite=True)
    assert contents_of(target) == expected


def test_a_backup_that_is_not_what_it_says_leaves_what_was_there(told: Database, target: str, tmp_path: Path) -> None:
    file = tmp_path / "backup"
    backup.back_up(told.url, file)
    description = json.loads(description_path(file).read_text())
    description["rows"]["machines"] += 1
    description_path(file).write_text(json.dumps(description))
    before = contents_of(target)
    with pytest.raises(BackupUnusable, match="not restored whole: machines differ in their number of rows"):
        backup.restore(target, file, overwrite=True)
    assert contents_of(target) == before


@pytest.mark.parametrize("there", [False, True])
@pytest.mark.usefixtures("file_only")
def test_a_refused_restore_leaves_nothing_behind(told: Database, target: str, tmp_path: Path, there: bool) -> None:
    """Neither what it has begun nor the lock that it held."""
    backup.back_up(told.url, tmp_path / "backup")
    if there:
        backup.restore(target, tmp_path / "backup")
    with description_path(tmp_path / "backup").open("r+") as opened:
        described = json.load(opened)
        described["rows"]["machines"] += 1
        opened.seek(0)
        json.dump(described, opened)
    with pytest.raises(BackupUnusable):
        backup.restore(target, tmp_path / "backup")
    assert [one.name for one in tmp_path.glob("target.db*")] == (["target.db"] if there else [])


def test_a_backup_under_way_is_left_alone_by_a_second_one(
    told: Database, target: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And what stands where it grows is nobody's to take away but its own."""
    synced = backup_file.synced_digest
    said: list[str] = []

    def another_meanwhile(file: Path) -> str:
        if file.name == "backup.part" and not said:
            with pytest.raises(BackupUnusable) as refused:
                backup.back_up(told.url, tmp_path / "backup")
            said.append(str(refused.value))
        return synced(file)

    monkeypatch.setattr(backup, "synced_digest", another_meanwhile)
    backup.back_up(told.url, tmp_path / "backup")
    assert len(said) == 1
    assert "backup.part exists already: another backup is being written to it" in said[0]
    backup.restore(target, tmp_path / "backup")
    assert contents_of(target) == contents(told)


@pytest.mark.parametrize("name", ["backup", "backup.json"])
def test_what_came_in_the_meantime_is_not_replaced(
    told: Database, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    synced = backup_file.synced_digest

    def written_meanwhile(file: Path) -> str:
        (tmp_path / name).write_text("somebody else's")
        return synced(file)

    monkeypatch.setattr(backup, "synced_digest", written_meanwhile)
    with pytest.raises(BackupUnusable, match=rf"{name} exists already: a backup never replaces another one"):
        backup.back_up(told.url, tmp_path / "backup")
    assert {one.name: one.read_text() for one in tmp_path.glob("backup*")} == {name: "somebody else's"}


def test_a_backup_that_cannot_be_described_leaves_nothing(
    told: Database, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as patched:
        patched.setattr(Path, "write_text", full)
        with pytest.raises(BackupUnusable, match=r"cannot be written: .*No space left"):
            backup.back_up(told.url, tmp_path / "backup")
    assert list(tmp_path.glob("backup*")) == []


@pytest.mark.parametrize("name", ["file/x", "b" * 251, "/", "loop/x"])
def test_a_name_that_no_backup_can_have_is_said(told: Database, target: str, tmp_path: Path, name: str) -> None:
    (tmp_path / "file").touch()
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    with pytest.raises(BackupUnusable, match=r"cannot be written|is no name of a file"):
        backup.back_up(told.url, tmp_path / name)
    with pytest.raises(BackupUnusable, match=r"is no backup"):
        backup.restore(target, tmp_path / name)
