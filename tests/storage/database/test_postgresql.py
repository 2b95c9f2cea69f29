"""Tests what holds of PostgreSQL only: connections that break, and a claim that outlives them."""

import hashlib
import json
import os
import threading
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path

import pytest
from sqlalchemy import event, text
from sqlalchemy.exc import DBAPIError

from storage.backup import backup
from storage.backup.backup_file import BackupUnusable, description_path
from storage.database.claim import DatabaseUnusable
from storage.database.engine import Database
from storage.machines import machines
from tests.databases import PostgresqlDatabases
from tests.plant import machine
from tests.postgresql import PostgresServer


@pytest.fixture
def plant(postgresql: PostgresServer, tmp_path: Path) -> Iterator[Database]:
    """A new database with the machine of `tests.plant`."""
    one = Database(PostgresqlDatabases(postgresql).new(tmp_path / f"broken_{os.urandom(4).hex()}"))
    with one.transaction() as session:
        machines.create(session, machine())
    yield one
    one.close()


def test_a_server_that_was_restarted_is_used_again(plant: Database, postgresql: PostgresServer) -> None:
    end_connections(plant, postgresql)
    plant.check()
    with plant.transaction() as session:
        machines.create(session, machine(id="other"))
    with plant.reading() as session:
        assert len(machines.list_all(session)) == 2


def test_what_was_read_before_a_connection_broke_stays_read(plant: Database, postgresql: PostgresServer) -> None:
    with plant.reading() as session:
        assert [row.id for row in machines.list_all(session)] == ["pump-7"]
        end_connections(plant, postgresql)
    plant.check()


def test_a_claim_whose_connection_broke_in_the_middle_is_taken_again(plant: Database, postgresql: PostgresServer) -> None:
    plant.claim(shared=True)

    breaks = iter([lambda: end_connections(plant, postgresql)])

    @event.listens_for(plant.engine, "before_cursor_execute")
    def broken(_connection: object, _cursor: object, statement: str, *_: object) -> None:
        if "pg_try_advisory_lock(" in statement:
            next(breaks, lambda: None)()

    with pytest.raises(DBAPIError):
        plant.hold_lock(7, 1)
    assert plant.hold_lock(7, 1)
    plant.check()


def test_a_claim_is_taken_again_after_a_restart(plant: Database, postgresql: PostgresServer) -> None:
    plant.claim()
    end_connections(plant, postgresql)
    plant.check()
    second = Database(plant.url)
    with pytest.raises(DatabaseUnusable, match="in use by another service"):
        second.claim()
    second.close()


def test_a_claim_that_another_service_took_meanwhile_is_said(plant: Database, postgresql: PostgresServer) -> None:
    plant.claim()
    end_connections(plant, postgresql)
    second = Database(plant.url)
    second.claim()
    with pytest.raises(DatabaseUnusable, match="in use by another service"):
        plant.check()
    second.close()


def test_a_claim_ends_with_its_database(plant: Database) -> None:
    for _ in range(20):
        one = Database(plant.url)
        one.claim()
        one.close()


def test_a_claim_that_is_given_up_a_moment_later_is_waited_for(plant: Database) -> None:
    """As that of a process that was killed."""
    first, second = Database(plant.url), Database(plant.url)
    first.claim()
    later = threading.Timer(0.5, first.close)
    later.start()
    second.claim()
    later.join()
    second.close()


def test_a_restore_that_fails_leaves_what_was_there(plant: Database, tmp_path: Path) -> None:
    """An archive that ends in the middle, with a checksum that fits: its tool finds out when the old data are aside."""
    file = tmp_path / "backup"
    made = backup.back_up(plant.url, file)
    whole = file.read_bytes()
    file.write_bytes(whole[: -len(whole) // 4])
    description = asdict(made) | {"sha256": hashlib.sha256(file.read_bytes()).hexdigest()}
    description_path(file).write_text(json.dumps(description))
    with pytest.raises(BackupUnusable, match="pg_restore failed"):
        backup.restore(plant.url, file, overwrite=True)
    with plant.transaction() as session:
        machines.create(session, machine(id="other"))
        assert [row.id for row in machines.list_all(session)] == ["other", "pump-7"]
        assert session.scalar(text("SELECT count(*) FROM pg_namespace WHERE nspname = 'rundown_before_restore'")) == 0


def end_connections(database: Database, server: PostgresServer) -> None:
    """End all connections, like a restart of the server."""
    name = database.engine.url.database
    server.execute(f"SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE datname = '{name}'")
