"""Tests what holds of SQLite only: files that are none or gone, locks of other processes, and when a transaction is on the
disk."""

import fcntl
import os
import shutil
import sqlite3
import stat
import threading
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any, TextIO

import pytest
from sqlalchemy import URL, event, insert

from storage.backup import backup
from storage.backup.transfer import TransferFailed, move
from storage.database import disk
from storage.database.claim import DatabaseUnusable
from storage.database.engine import Database
from storage.machines import fleet, machines
from storage.tables.findings import IdentificationRow, JobRow
from tests.databases import SqliteDatabases
from tests.plant import identification, machine, sqlite_url, store_identification


@pytest.fixture
def database(tmp_path: Path) -> Iterator[Database]:
    """A new file."""
    one = Database(sqlite_url(tmp_path / "rundown.db"))
    yield one
    one.close()


@pytest.fixture
def plant(database: Database) -> Database:
    """A database with the machine of `tests.plant`."""
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


@pytest.fixture
def usual_umask() -> Iterator[None]:
    """Yield what others may read unless somebody sees to it."""
    before = os.umask(0o022)
    yield
    os.umask(before)


def modes(folder: Path) -> dict[str, int]:
    """Return what of the store is in a folder, with who may read it."""
    return {one.name: stat.S_IMODE(one.stat().st_mode) for one in folder.glob("rundown.db*")}


@pytest.mark.usefixtures("usual_umask")
def test_a_new_store_is_its_owners_only(tmp_path: Path) -> None:
    database = Database(sqlite_url(tmp_path / "rundown.db"))
    database.claim()
    with database.transaction() as session:
        machines.create(session, machine())
    names = ("rundown.db", "rundown.db-wal", "rundown.db-shm", "rundown.db.lock")
    assert modes(tmp_path) == dict.fromkeys(names, 0o600)
    assert (tmp_path / "rundown.db").stat().st_size > 0
    database.close()


@pytest.mark.usefixtures("usual_umask")
def test_so_is_one_behind_a_link_to_where_nothing_is_yet(tmp_path: Path) -> None:
    (tmp_path / "link.db").symlink_to(tmp_path / "rundown.db")
    Database(sqlite_url(tmp_path / "link.db")).close()
    assert modes(tmp_path)["rundown.db"] == 0o600


@pytest.mark.usefixtures("usual_umask")
def test_a_store_that_is_there_keeps_its_mode(tmp_path: Path) -> None:
    sqlite3.connect(tmp_path / "rundown.db").close()
    (tmp_path / "rundown.db").chmod(0o640)
    database = Database(sqlite_url(tmp_path / "rundown.db"))
    assert modes(tmp_path) == dict.fromkeys(("rundown.db", "rundown.db-wal", "rundown.db-shm"), 0o640)
    database.close()


def test_a_directory_is_no_database(tmp_path: Path) -> None:
    with pytest.raises(DatabaseUnusable, match=r"database sqlite:///.* cannot be used: unable to open database file"):
        Database(sqlite_url(tmp_path))


def test_what_is_no_url_is_answered_with_how_one_is_written() -> None:
    with pytest.raises(
        DatabaseUnusable, match=r"database 'rundown' cannot be used: .* one is written as sqlite:///rundown.db"
    ):
        Database("rundown")


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
        assert len(machines.list_all(session)) == 2


@pytest.fixture
def linked(plant: Database, tmp_path: Path) -> str:
    """URL of the same database by another name, in another folder."""
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "elsewhere" / "link.db").symlink_to(plant.engine.url.database or "")
    return sqlite_url(tmp_path / "elsewhere" / "link.db")


def test_one_service_at_a_time_by_whatever_name(plant: Database, linked: str) -> None:
    plant.claim()
    second = Database(linked)
    with pytest.raises(DatabaseUnusable, match="in use by another service"):
        second.claim()
    second.close()


def test_what_a_link_leads_to_is_restored(plant: Database, linked: str, tmp_path: Path) -> None:
    backup.back_up(linked, tmp_path / "backup")
    with plant.transaction() as session:
        machines.create(session, machine(id="later"))
    plant.close()
    backup.restore(linked, tmp_path / "backup", overwrite=True)
    assert (tmp_path / "elsewhere" / "link.db").is_symlink()
    restored = Database(plant.url)
    with restored.reading() as session:
        assert [row.id for row in machines.list_all(session)] == ["pump-7"]
    restored.close()


def test_the_room_and_the_log_are_those_of_what_a_link_leads_to(
    plant: Database, linked: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A link may lead to another disk."""
    asked: list[Path] = []
    measured = shutil.disk_usage

    def noted(path: Path) -> object:
        asked.append(path)
        return measured(path)

    monkeypatch.setattr(shutil, "disk_usage", noted)
    second = Database(linked)
    assert disk.used(second, budget=None).data == disk.used(plant, budget=None).data
    second.close()
    assert asked == [Path(plant.engine.url.database or "").parent.resolve()] * 2


def test_a_database_is_not_moved_into_itself_by_another_name(plant: Database, linked: str) -> None:
    with pytest.raises(TransferFailed, match="are the same database"):
        move(plant.url, linked)


def test_a_uri_of_sqlite_is_not_taken(tmp_path: Path) -> None:
    with pytest.raises(DatabaseUnusable, match=r"`uri` is not taken: name the file itself"):
        Database(f"sqlite:///file:{tmp_path}/rundown.db?uri=true")
    assert list(tmp_path.iterdir()) == []


def test_a_claim_that_cannot_be_laid_down_is_said(plant: Database, tmp_path: Path) -> None:
    """A directory stands where the lock file goes."""
    (tmp_path / "rundown.db.lock").mkdir()
    with pytest.raises(DatabaseUnusable, match=r"cannot be claimed: .*rundown\.db\.lock"):
        plant.claim()


def test_a_claim_takes_its_lock_file_away_and_no_other_one(plant: Database, tmp_path: Path) -> None:
    lock = tmp_path / "rundown.db.lock"
    with closing(Database(plant.url)) as other:
        plant.claim()
        with pytest.raises(DatabaseUnusable, match="in use by another service"):
            other.claim()
    assert lock.exists()
    plant.close()
    assert not lock.exists()
    lock.touch()
    with closing(Database(plant.url)) as later:
        later.claim()
    assert lock.exists()


def test_a_lock_file_that_was_just_taken_away_locks_nobody_out(
    plant: Database, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its holder ends between the moment in which it is opened and the one in which it is locked."""
    lock, locking, calls = tmp_path / "rundown.db.lock", fcntl.flock, list[int]()

    def lock_late(file: TextIO, how: int) -> None:
        calls.append(how)
        if len(calls) == 1:
            lock.unlink()
        locking(file, how)

    monkeypatch.setattr(fcntl, "flock", lock_late)
    plant.claim()
    assert len(calls) == 2
    with lock.open() as file, pytest.raises(BlockingIOError):
        locking(file, fcntl.LOCK_SH | fcntl.LOCK_NB)


def test_signs_that_mean_something_in_urls_mean_nothing_in_names_of_files(tmp_path: Path) -> None:
    folder = tmp_path / "50%25 #1"
    folder.mkdir()
    database = Database(URL.create("sqlite", database=str(folder / "rundown.db")).render_as_string())
    with database.transaction() as session:
        machines.create(session, machine())
    made = backup.back_up(database.url, folder / "what?mode=ro#2")
    database.close()
    assert made.rows["machines"] == 1
    assert backup.restore(database.url, folder / "what?mode=ro#2", overwrite=True).backup == made
    assert {one.name for one in tmp_path.iterdir()} == {folder.name}
    assert sorted(one.name for one in folder.glob("what*")) == ["what?mode=ro#2", "what?mode=ro#2.json"]


def test_what_happened_in_a_day_is_counted_without_reading_years(plant: Database) -> None:
    days = range(2, 366)
    with plant.transaction() as session:
        first = store_identification(session, identification(), run_id=1)
        known = {column.name: getattr(first, column.name) for column in IdentificationRow.__table__.columns}
        asking = session.get_one(JobRow, first.job_id)
        job = {column.name: getattr(asking, column.name) for column in JobRow.__table__.columns}
        session.execute(insert(JobRow), [job | {"id": n, "request": f"run:{n}"} for n in days])
        session.execute(insert(IdentificationRow), [known | {"id": n, "job_id": n, "computed_at": n} for n in days])
    with plant.engine.connect().execution_options(isolation_level="AUTOCOMMIT") as connection:
        connection.exec_driver_sql("ANALYZE")
    asked: list[tuple[str, Any]] = []
    event.listen(plant.engine, "before_cursor_execute", lambda *args: asked.append((args[2], args[3])))
    with plant.reading() as session:
        (pump,) = fleet.glances(session, fleet.list_all(session), since=days[-10])
    assert pump.since["identifications"] == 10 + 1  # of those days, and the first, of now
    with plant.engine.connect() as connection:
        plans = [connection.exec_driver_sql(f"EXPLAIN QUERY PLAN {query}", given).all() for query, given in list(asked)]
    steps = [step[-1] for plan in plans for step in plan]
    assert [step for step in steps if "SCAN identifications" in step] == []
    assert any("SEARCH identifications USING" in step and "computed_at>?" in step for step in steps)
