"""The database of either kind: its schema against the tables, opening it again, and who reads and writes at the same time."""

import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import alembic.command
import alembic.config
import pytest
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from sqlalchemy import JSON, inspect, select, text
from sqlalchemy.exc import IntegrityError

from storage.database.claim import DatabaseUnusable
from storage.database.engine import Database
from storage.findings import identifications
from storage.machines import machines
from storage.measurements import quarantine
from storage.measurements.quarantine import Rejection
from storage.paging import ordered
from storage.tables.base import Base
from storage.tables.machines import MachineRow
from storage.tables.measurements import SourceRow
from tests.databases import Databases
from tests.plant import START, identification, machine, store_identification
from tests.storage.migration import migrate


def tables(database: Database) -> set[str]:
    return set(inspect(database.engine).get_table_names())


def other_default(*found: Any) -> bool | None:
    """Compare defaults of JSON here, as PostgreSQL cannot; leave all others to Alembic."""
    _, inspected_column, _, inspected, _, rendered = found
    if isinstance(inspected_column.type, JSON) and inspected is not None:
        return bool(inspected.removesuffix("::json").strip("'") != rendered.strip("'"))
    return None


def test_migrations_lead_to_the_tables_of_the_code(database: Database) -> None:
    with database.engine.connect() as connection:
        context = MigrationContext.configure(connection, opts={"compare_type": True, "compare_server_default": other_default})
        assert compare_metadata(context, Base.metadata) == []


def test_downgrade_removes_every_table_and_upgrade_brings_it_back(plant: Database) -> None:
    expected = set(Base.metadata.tables) | {"alembic_version"}
    assert tables(plant) == expected
    migrate(plant, alembic.command.downgrade, "base")
    assert tables(plant) == {"alembic_version"}
    migrate(plant, alembic.command.upgrade, "head")
    assert tables(plant) == expected


def test_opened_again_holds_what_was_stored(plant: Database) -> None:
    plant.close()
    again = Database(plant.url)
    with again.reading() as session:
        assert machines.document(session, "pump-7") == machine()
    again.close()


def in_threads(tasks: list[Callable[[], None]]) -> None:
    threads = [threading.Thread(target=task) for task in tasks]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(30)
    assert not any(thread.is_alive() for thread in threads)


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


@pytest.mark.parametrize(
    "url",
    [
        "nosuch://operator:secret@somewhere/db",
        "postgresql+psycopg//operator:secret@somewhere/db",
        "postgresql+psycopg://operator@127.0.0.1:1/db?password=secret&sslpassword=secret",
        "postgresql+psycopg://operator:secret@127.0.0.1:abc/db",
        "postgresql+psycopg://operator:sec:ret@127.0.0.1:secret/db",
        "password=secret",
    ],
)
def test_the_password_is_not_shown(url: str) -> None:
    with pytest.raises(DatabaseUnusable) as caught:
        Database(url)
    assert "secret" not in str(caught.value)


def test_a_database_of_a_newer_service_is_said(database: Database) -> None:
    with database.transaction() as session:
        session.execute(text("UPDATE alembic_version SET version_num = '9999'"))
    database.close()
    with pytest.raises(DatabaseUnusable, match="9999"):
        Database(database.url)


def test_a_transaction_is_stored_whole_or_not_at_all(plant: Database) -> None:
    def add_and_fail() -> None:
        with plant.transaction() as session:
            machines.create(session, machine(id="other"))
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        add_and_fail()
    with plant.reading() as session:
        assert [row.id for row in machines.list_all(session)] == ["pump-7"]


def test_what_is_only_read_is_not_stored(plant: Database) -> None:
    with plant.reading() as session:
        machines.create(session, machine(id="other"))
    with plant.reading() as session:
        assert [row.id for row in machines.list_all(session)] == ["pump-7"]


def test_references_are_enforced(database: Database) -> None:
    row = SourceRow(
        machine_id="unknown", source="s", epoch=1, next_sequence=0, received=0, duplicates=0, lost=0, late=0, last_time=0
    )

    def add() -> None:
        with database.transaction() as session:
            session.add(row)

    with pytest.raises(IntegrityError, match=r"(?i)foreign key"):
        add()


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
            assert [row.id for row in machines.list_all(reading)] == ["pump-7"]


def test_a_reader_sees_one_state_to_the_end(plant: Database) -> None:
    with plant.reading() as reading:
        assert len(machines.list_all(reading)) == 1
        with plant.transaction() as writing:
            machines.create(writing, machine(id="other"))
        assert len(machines.list_all(reading)) == 1
    with plant.reading() as reading:
        assert len(machines.list_all(reading)) == 2


def test_several_processes_may_open_a_new_database_at_once(databases: Databases, tmp_path: Path) -> None:
    url = databases.new(tmp_path / "new.db")
    failures: list[Exception] = []

    def open_it() -> None:
        try:
            Database(url).close()
        except Exception as error:  # noqa: BLE001 - the test names it
            failures.append(error)

    in_threads([open_it] * 4)
    assert failures == []
    databases.drop(url)


def test_lists_are_in_the_order_of_their_letters_codes(database: Database) -> None:
    """Whatever language the server sorts in: a list goes on behind a key, which is compared here and there."""
    ids = ["Pump-1", "a", "b-2", "b1", "b_2", "pump-1", "B2", "é-1"]
    with database.transaction() as session:
        for name in ids:
            session.add(MachineRow(id=name, plant="p", revision=1, created_at=1))
    with database.reading() as session:
        assert [row.id for row in machines.list_all(session)] == sorted(ids)
        query = select(MachineRow.id)
        passed: list[str] = []
        while part := session.scalars(ordered(query, (MachineRow.id,), tuple(passed[-1:]) or None, descending=False).limit(3)):
            found = part.all()
            if not found:
                break
            passed += found
        assert passed == sorted(ids)


def test_one_service_at_a_time(database: Database) -> None:
    first, second = Database(database.url), Database(database.url)
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
