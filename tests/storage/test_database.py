"""The database: its schema against the tables, opening it again, opening what is none, and writers at the same time."""

import sqlite3
import threading
from collections.abc import Callable
from pathlib import Path

import alembic.command
import alembic.config
import pytest
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from sqlalchemy import inspect, text
from sqlalchemy.exc import IntegrityError

from storage import identifications, machines, quarantine
from storage.database import MIGRATIONS, Database, DatabaseUnusable
from storage.quarantine import Rejection
from storage.tables import Base, SourceRow
from tests.plant import START, identification, machine, sqlite_url, store_identification


def migrate(database: Database, command: Callable[[alembic.config.Config, str], None], revision: str) -> None:
    config = alembic.config.Config()
    config.set_main_option("script_location", str(MIGRATIONS))
    with database.engine.begin() as connection:
        config.attributes["connection"] = connection
        command(config, revision)


def tables(database: Database) -> set[str]:
    return set(inspect(database.engine).get_table_names())


def test_migrations_lead_to_the_tables_of_the_code(database: Database) -> None:
    with database.engine.connect() as connection:
        context = MigrationContext.configure(connection, opts={"compare_type": True, "compare_server_default": True})
        assert compare_metadata(context, Base.metadata) == []


def test_downgrade_removes_every_table_and_upgrade_brings_it_back(plant: Database) -> None:
    expected = set(Base.metadata.tables) | {"alembic_version"}
    assert tables(plant) == expected
    migrate(plant, alembic.command.downgrade, "base")
    assert tables(plant) == {"alembic_version"}
    migrate(plant, alembic.command.upgrade, "head")
    assert tables(plant) == expected


def test_opened_again_holds_what_was_stored(plant: Database, tmp_path: Path) -> None:
    plant.close()
    again = Database(sqlite_url(tmp_path / "rundown.db"))
    with again.reading() as session:
        assert machines.document(session, "pump-7") == machine()
    again.close()


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


def in_threads(tasks: list[Callable[[], None]]) -> None:
    threads = [threading.Thread(target=task) for task in tasks]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(30)
    assert not any(thread.is_alive() for thread in threads)


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


@pytest.mark.parametrize(
    ("url", "said"),
    [
        ("nosuch://somewhere/db", "nosuch"),
        ("not a URL", "not a URL"),
        ("", "cannot be used"),
        ("sqlite+nosuch:///x.db", "nosuch"),
    ],
)
def test_a_url_of_no_known_database_is_said(url: str, said: str) -> None:
    with pytest.raises(DatabaseUnusable, match=said):
        Database(url)


def test_the_password_is_not_shown() -> None:
    with pytest.raises(DatabaseUnusable) as caught:
        Database("nosuch://operator:secret@somewhere/db")
    assert "secret" not in str(caught.value)


def test_a_database_of_a_newer_service_is_said(tmp_path: Path) -> None:
    url = sqlite_url(tmp_path / "rundown.db")
    newer = Database(url)
    with newer.transaction() as session:
        session.execute(text("UPDATE alembic_version SET version_num = '9999'"))
    newer.close()
    with pytest.raises(DatabaseUnusable, match="9999"):
        Database(url)


def test_check_says_when_the_database_is_gone(database: Database, tmp_path: Path) -> None:
    database.check()
    database.close()
    unusable(tmp_path / "rundown.db")
    with pytest.raises(DatabaseUnusable, match="was deleted or replaced"):
        database.check()


def unusable(path: Path) -> None:
    """A directory where the database was."""
    for name in (f"{path.name}-wal", f"{path.name}-shm", path.name):
        (path.parent / name).unlink(missing_ok=True)
    path.mkdir()


def test_a_transaction_is_stored_whole_or_not_at_all(plant: Database) -> None:
    def add_and_fail() -> None:
        with plant.transaction() as session:
            machines.create(session, machine(id="other"))
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        add_and_fail()
    with plant.reading() as session:
        assert [row.id for row in machines.every(session)] == ["pump-7"]


def test_what_is_only_read_is_not_stored(plant: Database) -> None:
    with plant.reading() as session:
        machines.create(session, machine(id="other"))
    with plant.reading() as session:
        assert [row.id for row in machines.every(session)] == ["pump-7"]


def test_references_are_enforced(database: Database) -> None:
    row = SourceRow(
        machine_id="unknown", source="s", epoch=1, next_sequence=0, received=0, duplicates=0, lost=0, late=0, last_time=0
    )

    def add() -> None:
        with database.transaction() as session:
            session.add(row)

    with pytest.raises(IntegrityError, match="FOREIGN KEY"):
        add()


def test_samples_are_durable_before_they_count_as_received(database: Database) -> None:
    with database.engine.connect() as connection:
        assert connection.exec_driver_sql("PRAGMA journal_mode").scalar() == "wal"
        assert connection.exec_driver_sql("PRAGMA synchronous").scalar() == 2  # FULL


def test_writers_at_the_same_time_wait_for_each_other(database: Database) -> None:
    """Each reads before it writes, which would fail with 'locked' if the lock were taken only then."""
    writers, turns = 4, 10
    start = threading.Barrier(writers)
    failures: list[Exception] = []

    def write() -> None:
        start.wait(5)
        try:
            for _ in range(turns):
                with database.transaction() as session:
                    quarantine.counts(session)
                    quarantine.add(session, [Rejection(START, "key", None, "bad_frame", "detail", b"")])
        except Exception as error:  # noqa: BLE001 - the test names it
            failures.append(error)

    in_threads([write] * writers)
    assert failures == []
    with database.reading() as session:
        assert quarantine.counts(session) == {"bad_frame": writers * turns}


def test_a_reader_is_not_held_up_by_a_writer(plant: Database) -> None:
    with plant.transaction() as writing:
        machines.create(writing, machine(id="other"))
        with plant.reading() as reading:
            assert [row.id for row in machines.every(reading)] == ["pump-7"]


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


def test_one_service_at_a_time(tmp_path: Path) -> None:
    first, second = Database(sqlite_url(tmp_path / "x.db")), Database(sqlite_url(tmp_path / "x.db"))
    first.claim()
    with pytest.raises(DatabaseUnusable, match="in use by another service"):
        second.claim()
    first.close()
    second.claim()
    second.close()


def test_identifications_of_an_older_release_survive_the_migration(plant: Database) -> None:
    with plant.transaction() as session:
        found = store_identification(session, identification(), run_id=1).id
    migrate(plant, alembic.command.downgrade, "0001")
    migrate(plant, alembic.command.upgrade, "head")
    with plant.reading() as session:
        row = identifications.get(session, found)
        assert (row.noise_relative, row.noise_floor, row.outliers, row.point) == (None, None, None, None)
        assert row.chi_square == 123.0
        assert identifications.estimates(session, found)
