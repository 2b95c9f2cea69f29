"""A file of an SQLite store is deleted, replaced or cut off while it is open: what can be saved is, nothing more is taken."""

import os
import shutil
import sqlite3
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import closing, suppress
from pathlib import Path

import pytest
from sqlalchemy import text
from sqlalchemy.exc import OperationalError

from storage.backup import backup
from storage.database.change_counts import WATCHED, Changes
from storage.database.claim import DatabaseUnusable
from storage.database.engine import Database
from storage.database.plant_scope import PlantScope
from storage.machines import machines
from tests.plant import machine, sqlite_url, wait_until


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
    """Return what somebody finds who has nothing but the main file: as after a kill. Copied by another process: to open and
    close the file in this one would take SQLite's locks from it.
    """
    copy = folder / "alone" / "rundown.db"
    copy.parent.mkdir(exist_ok=True)
    subprocess.run(["cp", str(folder / "rundown.db"), str(copy)], check=True)
    script = f"import sqlite3; print(*(row[0] for row in sqlite3.connect({str(copy)!r}).execute('SELECT id FROM machines')))"
    return subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout.split()


def replaced(file: Path) -> None:
    """Replace the file by a copy of it."""
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
    """Its writes would not fit the index that those share which are open."""
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


def cut_to(length: float) -> Callable[[Path], None]:
    """Cut a file in place to a part of its length."""

    def cut(file: Path) -> None:
        os.truncate(file, int(length * file.stat().st_size))

    return cut


def zeroed(file: Path) -> None:
    """Overwrite a file in place, at its length: as when what was written beyond the cut has made it long again."""
    size = file.stat().st_size
    os.truncate(file, 0)
    os.truncate(file, size)


def overwritten(at: int, size: int) -> Callable[[Path], None]:
    """Write into a file in place what was not there."""

    def overwrite(file: Path) -> None:
        with file.open("r+b") as opened:
            opened.seek(at)
            opened.write(b"\xa5" * size)

    return overwrite


def saved(database: Database) -> bool:
    """Return whether all that can be is, behind another look."""
    with suppress(DatabaseUnusable):
        database.check()
    return database.needs_restart


def names(folder: Path) -> list[str]:
    """The machines in a store that is whole, as the next start finds them."""
    again = Database(sqlite_url(folder / "rundown.db"))
    with closing(again), again.reading() as session:
        assert session.execute(text("PRAGMA integrity_check")).scalar() == "ok"
        return list(machines.list_ids(session))


@pytest.mark.parametrize("looked", [True, False])
@pytest.mark.parametrize("befalls", [cut_to(0), cut_to(0.25), cut_to(0.5), zeroed])
def test_of_a_log_that_was_cut_off_the_rest_is_kept_and_the_file_stays_whole(
    tmp_path: Path, befalls: Callable[[Path], None], looked: bool
) -> None:
    """It is kept whether the service looks before it stops, or stops at once."""
    database = Database(sqlite_url(tmp_path / "rundown.db"))
    for number in range(40):
        add(database, f"machine-{number:02}")
    with database.engine.connect() as connection:
        _, logged, done = connection.exec_driver_sql("PRAGMA wal_checkpoint(PASSIVE)").one()
        assert logged == done > 0
    for number in range(40, 80):
        add(database, f"machine-{number:02}")
    befalls(tmp_path / "rundown.db-wal")
    if looked:
        with pytest.raises(DatabaseUnusable, match=r"db-wal was cut off .* \d+ pages; .*Nothing more is stored"):
            database.check()
        assert database.needs_restart
    with pytest.raises(OperationalError, match="was cut off"):
        add(database, "later")
    database.close()
    found = names(tmp_path)
    assert found == [f"machine-{number:02}" for number in range(len(found))]
    assert 40 <= len(found) < 80


@pytest.mark.parametrize("damaged", [cut_to(0), cut_to(0.3), zeroed, overwritten(4096, 4096), overwritten(70_000, 8)])
def test_nothing_is_lost_of_a_log_whose_frames_the_main_file_holds(tmp_path: Path, damaged: Callable[[Path], None]) -> None:
    """It goes on without a restart, and says that all of it is to be looked at."""
    database = Database(sqlite_url(tmp_path / "rundown.db"))
    for number in range(40):
        add(database, f"machine-{number:02}")
    with database.engine.connect() as connection:
        connection.exec_driver_sql("PRAGMA wal_checkpoint(PASSIVE)")
    damaged(tmp_path / "rundown.db-wal")
    database.check()
    assert "pages of its log were overwritten" in str(database.damage.trouble)
    add(database, "machine-40")
    database.check_integrity(within_s=60, stopped=lambda: False)
    assert database.damage.trouble is None
    database.close()
    assert len(names(tmp_path)) == 41


def test_a_page_of_the_log_of_which_there_is_a_newer_one_costs_nothing(tmp_path: Path) -> None:
    """Noticed by its checksum, since its header is whole, before a crash loses all that stands behind it."""
    database = Database(sqlite_url(tmp_path / "rundown.db"))
    with database.engine.connect() as connection:
        connection.exec_driver_sql("PRAGMA wal_checkpoint(TRUNCATE)")
    for number in range(40):
        add(database, f"machine-{number:02}")
    overwritten(32 + 24 + 100, 1000)(tmp_path / "rundown.db-wal")  # the first change of the first page that was written
    database.check()
    assert "pages of its log were overwritten" in str(database.damage.trouble)
    assert (tmp_path / "rundown.db-wal").stat().st_size == 0
    add(database, "machine-40")
    database.close()
    assert len(names(tmp_path)) == 41


@pytest.mark.parametrize("looked", [True, False])
def test_a_page_of_the_log_that_is_the_newest_takes_the_store_back_to_before_it(tmp_path: Path, looked: bool) -> None:
    database = Database(sqlite_url(tmp_path / "rundown.db"))
    with database.engine.connect() as connection:
        connection.exec_driver_sql("PRAGMA wal_checkpoint(TRUNCATE)")
    for number in range(40):
        add(database, f"machine-{number:02}")
    log = tmp_path / "rundown.db-wal"
    overwritten(log.stat().st_size - 1000, 1000)(log)
    if looked:
        wait_until(lambda: saved(database))  # a look takes in a part of the log
        with pytest.raises(DatabaseUnusable, match="was cut off or overwritten"):
            database.check()
    database.close()
    found = names(tmp_path)
    assert found == [f"machine-{number:02}" for number in range(39)]


def written_over(file: Path, by: Path) -> None:
    """Overwrite the file like `cp`: in place, and not at once."""
    with file.open("wb") as target, by.open("rb") as source:
        while piece := source.read(65_536):
            target.write(piece)
            target.flush()


def copied(database: Database, folder: Path) -> Path:
    """A copy of the main file, as of the last checkpoint."""
    with database.engine.connect() as connection:
        connection.exec_driver_sql("PRAGMA wal_checkpoint(TRUNCATE)")
    subprocess.run(["cp", str(folder / "rundown.db"), str(folder / "copy")], check=True)
    return folder / "copy"


def backed_up(database: Database, folder: Path) -> Path:
    backup.back_up(database.url, folder / "backup")
    return folder / "backup"


@pytest.mark.parametrize("looked", [True, False])
@pytest.mark.parametrize("copy", [copied, backed_up])
def test_a_file_that_was_written_over_the_main_one_is_left_as_it_is(
    tmp_path: Path, copy: Callable[[Database, Path], Path], looked: bool
) -> None:
    """Nothing of the log gets into it, which would fit nothing there."""
    database = Database(sqlite_url(tmp_path / "rundown.db"))
    for number in range(20):
        add(database, f"machine-{number:02}")
    made = copy(database, tmp_path)
    for number in range(20, 60):
        add(database, f"machine-{number:02}")
    with database.engine.connect() as connection:
        connection.exec_driver_sql("PRAGMA wal_checkpoint(TRUNCATE)")
    add(database, "machine-60")
    written_over(tmp_path / "rundown.db", made)
    if looked:
        with pytest.raises(DatabaseUnusable, match=r"another file was written over the database file .*Do not kill"):
            database.check()
        wait_until(lambda: saved(database))
        with pytest.raises(DatabaseUnusable, match=r"since that one was made is lost.* `rundown restore`"):
            database.check()
    with pytest.raises(OperationalError, match="was written over"):
        add(database, "later")
    database.close()
    assert names(tmp_path) == [f"machine-{number:02}" for number in range(20)]
    assert (tmp_path / "rundown.db-wal.cut").stat().st_size > 0


def test_what_was_written_over_is_written_back_where_the_log_has_all(tmp_path: Path) -> None:
    database = Database(sqlite_url(tmp_path / "rundown.db"))
    add(database, "first")
    made = backed_up(database, tmp_path)
    add(database, "second")
    written_over(tmp_path / "rundown.db", made)
    wait_until(lambda: saved(database))
    with pytest.raises(DatabaseUnusable, match="All that was acknowledged was in its log, and is written back"):
        database.check()
    database.close()
    assert names(tmp_path) == ["first", "second"]


def frame_zeroed(file: Path, number: int) -> None:
    """Overwrite one frame of a log, its header and its page, in place."""
    size = 24 + 4096
    with file.open("r+b") as opened:
        opened.seek(32 + number * size)
        opened.write(bytes(size))


def test_a_hole_in_the_middle_of_a_log_is_seen_by_the_next_looks(tmp_path: Path) -> None:
    database = Database(sqlite_url(tmp_path / "rundown.db"))
    with database.engine.connect() as connection:
        connection.exec_driver_sql("PRAGMA wal_checkpoint(TRUNCATE)")
    for number in range(40):
        add(database, f"machine-{number:02}")
    database.check()
    frame_zeroed(tmp_path / "rundown.db-wal", 60)
    with pytest.raises(DatabaseUnusable, match="was cut off or overwritten"):
        database.check()
    database.close()
    found = names(tmp_path)
    assert found == [f"machine-{number:02}" for number in range(len(found))]
    assert 5 < len(found) < 40


def test_a_hole_that_nobody_saw_is_not_copied_by_the_last_checkpoint(tmp_path: Path) -> None:
    database = Database(sqlite_url(tmp_path / "rundown.db"))
    for number in range(40):
        add(database, f"machine-{number:02}")
    before = (tmp_path / "rundown.db-wal").read_bytes()
    frame_zeroed(tmp_path / "rundown.db-wal", 60)
    database.close()
    assert len(names(tmp_path)) < 40
    kept = (tmp_path / "rundown.db-wal.cut").read_bytes()  # for a rescue: all but the hole
    assert len(kept) == len(before)
    assert kept[: 32 + 60 * (24 + 4096)] == before[: 32 + 60 * (24 + 4096)]
    assert (tmp_path / "rundown.db-wal.cut").stat().st_mode & 0o777 == 0o600


def test_a_log_of_which_no_copy_can_be_made_damages_nothing_either(
    database: Database, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    """As on a full disk."""
    (tmp_path / "rundown.db-wal.cut").mkdir()
    cut_to(0)(tmp_path / "rundown.db-wal")
    database.close()
    assert "cannot be copied" in caplog.text
    assert names(tmp_path) == []


def test_a_log_that_is_cut_off_within_a_transaction_takes_no_commit(database: Database, tmp_path: Path) -> None:
    def interrupted() -> None:
        with database.transaction() as session:
            machines.create(session, machine(id="second"))
            session.flush()
            cut_to(0)(tmp_path / "rundown.db-wal")

    with pytest.raises(OperationalError, match="was cut off"):
        interrupted()
    database.close()
    assert names(tmp_path) == []


def test_a_log_that_is_cut_off_and_then_deleted_damages_nothing(database: Database, tmp_path: Path) -> None:
    cut_to(0)(tmp_path / "rundown.db-wal")
    (tmp_path / "rundown.db-wal").unlink()
    with pytest.raises(DatabaseUnusable, match="was cut off"):
        database.check()
    database.close()
    assert names(tmp_path) == []


def test_checkpoints_of_every_kind_are_no_cut(database: Database, tmp_path: Path) -> None:
    """Whoever makes them: a log that another program has emptied, or begun anew, is whole."""
    script = (
        "import sqlite3, sys; print(sqlite3.connect(sys.argv[1]).execute(f'PRAGMA wal_checkpoint({sys.argv[2]})').fetchone())"
    )
    for number, kind in enumerate(("PASSIVE", "FULL", "RESTART", "TRUNCATE") * 2):
        told = subprocess.run(
            [sys.executable, "-c", script, str(tmp_path / "rundown.db"), kind], capture_output=True, text=True, check=True
        )
        assert told.stdout.startswith("(0,")
        database.check()
        add(database, f"machine-{number}")
        database.check()


def test_a_log_that_grows_and_is_begun_again_while_others_look_is_whole(database: Database) -> None:
    """SQLite makes a checkpoint of its own after a thousand pages."""
    stop, troubles = threading.Event(), []

    def look() -> None:
        while not stop.is_set():
            try:
                database.check()
            except DatabaseUnusable as error:
                troubles.append(error)
                return

    threads = [threading.Thread(target=look) for _ in range(2)]
    for one in threads:
        one.start()
    try:
        for number in range(300):
            add(database, f"machine-{number:03}")
    finally:
        stop.set()
        for one in threads:
            one.join()
    assert troubles == []
