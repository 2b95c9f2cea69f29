"""Tests who gets in after a restore: not who was logged out since, nor with a key that was revoked since, or may have been."""

from contextlib import closing
from pathlib import Path

import alembic.command
import alembic.config
import pytest

from service.security import api_keys
from service.security.role import Role
from storage.backup import backup
from storage.backup.restored_access import RestoredAccess
from storage.clock import now
from storage.database.engine import Database
from storage.operation import api_keys as keys
from storage.operation import audit, browser_sessions
from tests.databases import Databases
from tests.end_to_end.processes import rundown
from tests.storage.migration import migrate

A_DAY = 86_400 * 1_000_000_000


@pytest.fixture
def made(database: Database, tmp_path: Path) -> dict[str, tuple[str, str]]:
    """Prefix and text of three keys, by their names, in a database with somebody logged in, which was backed up then."""
    found = {}
    with database.transaction() as session:
        for name in ("good", "revoked", "rotated"):
            row, text = api_keys.create(session, name=name, role=Role.ADMIN, plants=None, days=100.0)
            found[name] = row.prefix, text
        api_keys.revoke(session, api_keys.create(session, name="old", role=Role.ADMIN, plants=None, days=1.0)[0].prefix)
        browser_sessions.begin(
            session,
            cookie_hash="cookie",
            name="anna",
            role="admin",
            plants=None,
            key_prefix=found["good"][0],
            token="token",
            expires_at=now() + A_DAY,
        )
    backup.back_up(database.url, tmp_path / "backup")
    with database.transaction() as session:
        api_keys.revoke(session, found["revoked"][0])
        api_keys.rotate(session, found["rotated"][0], overlap_days=0.0, days=100.0)
    return found


def opening(url: str, made: dict[str, tuple[str, str]]) -> set[str]:
    """Names of the keys that open something."""
    with closing(Database(url)) as database, database.reading() as session:
        assert browser_sessions.find(session, "cookie", at=now()) is None
        assert audit.verify(session) == []
        return {name for name, (prefix, text) in made.items() if api_keys.is_valid_secret(keys.find(session, prefix), text)}


def test_what_was_revoked_stays_so(database: Database, made: dict[str, tuple[str, str]], tmp_path: Path) -> None:
    database.close()
    found = backup.restore(database.url, tmp_path / "backup", overwrite=True).access
    assert found == RestoredAccess(revoked=(made["revoked"][0],), waiting=(), sessions=1)
    assert opening(database.url, made) == {"good"}


def test_where_nothing_is_known_of_them_keys_wait(
    databases: Databases, made: dict[str, tuple[str, str]], tmp_path: Path
) -> None:
    target = databases.new(tmp_path / "target.db")
    found = backup.restore(target, tmp_path / "backup").access
    assert found == RestoredAccess(revoked=(), waiting=tuple(prefix for prefix, _ in made.values()), sessions=1)
    assert opening(target, made) == set()
    with closing(Database(target)) as restored, restored.transaction() as session:
        assert keys.count_unconfirmed(session) == 3
        with pytest.raises(ValueError, match="waits for a confirmation"):
            api_keys.rotate(session, made["good"][0], overlap_days=1.0, days=1.0)
        api_keys.confirm(session, made["good"][0])
        with pytest.raises(ValueError, match="does not wait"):
            api_keys.confirm(session, made["good"][0])
        assert keys.any_exist(session)
    assert opening(target, made) == {"good"}
    # What waits goes on to wait when the same is restored once more.
    assert backup.restore(target, tmp_path / "backup", overwrite=True).access.waiting == found.waiting[1:]
    assert opening(target, made) == {"good"}


def test_a_backup_without_keys_opens_no_store_that_has_some(database: Database, tmp_path: Path) -> None:
    backup.back_up(database.url, tmp_path / "backup")
    with database.transaction() as session:
        row, text = api_keys.create(session, name="first", role=Role.ADMIN, plants=None, days=100.0)
        prefix = row.prefix
    database.close()
    told = rundown("restore", str(tmp_path / "backup"), "--overwrite", "--database", database.url)
    assert told.returncode == 1
    assert "older than the first API key" in told.stderr
    assert "--without-keys" in told.stderr
    assert opening(database.url, {"first": (prefix, text)}) == {"first"}


def test_that_no_key_is_left_is_said(database: Database, tmp_path: Path) -> None:
    backup.back_up(database.url, tmp_path / "backup")
    with database.transaction() as session:
        api_keys.create(session, name="first", role=Role.ADMIN, plants=None, days=100.0)
    database.close()
    told = rundown("restore", str(tmp_path / "backup"), "--overwrite", "--without-keys", "--database", database.url)
    assert told.returncode == 0, told.stderr
    assert "the backup is older than the first API key" in told.stderr
    # What was said once is known: the store that is replaced now has none either.
    assert not backup.restore(database.url, tmp_path / "backup", overwrite=True).access.keyless


def test_a_store_that_cannot_be_read_knows_nothing(
    made: dict[str, tuple[str, str]], tmp_path: Path, database: Database
) -> None:
    if database.kind != "sqlite":
        pytest.skip("a server's tables are not overwritten")
    database.close()
    (tmp_path / "rundown.db").write_bytes(b"no database" * 500)
    assert len(backup.restore(database.url, tmp_path / "backup", overwrite=True).access.waiting) == 3
    assert opening(database.url, made) == set()


def test_a_backup_of_an_older_schema_stays_one(database: Database, databases: Databases, tmp_path: Path) -> None:
    """So that the release that made it can start with it."""
    with database.transaction() as session:
        row, text = api_keys.create(session, name="good", role=Role.ADMIN, plants=None, days=100.0)
        prefix = row.prefix
    migrate(database, alembic.command.downgrade, "0014")
    made = backup.back_up(database.url, tmp_path / "backup")
    target = databases.new(tmp_path / "target.db")
    assert backup.restore(target, tmp_path / "backup").access == RestoredAccess(revoked=(), waiting=(prefix,), sessions=0)
    again = backup.back_up(target, tmp_path / "again")
    assert (again.schema_revision, again.rows) == (made.schema_revision, made.rows)
    assert opening(target, {"good": (prefix, text)}) == set()


@pytest.mark.long
def test_the_commands_say_so(made: dict[str, tuple[str, str]], databases: Databases, tmp_path: Path) -> None:
    target = databases.new(tmp_path / "target.db")
    prefixes = [prefix for prefix, _ in made.values()]
    told = rundown("restore", str(tmp_path / "backup"), "--database", target)
    assert told.returncode == 0, told.stderr
    assert "1 browser sessions of the backup are over" in told.stdout
    assert f"keys that open nothing before they are confirmed, as they may have been revoked since: {', '.join(prefixes)}" in (
        told.stdout
    )
    listed = rundown("key", "list", "--database", target).stdout
    assert [line.split()[1] for line in listed.splitlines()] == ["waits", "waits", "waits", "revoked"]
    if target.startswith("sqlite"):
        examined = rundown("doctor", RUNDOWN_DATABASE=target, RUNDOWN_PORT="1", RUNDOWN_ZENOH_LISTEN="[]").stdout
        assert "warning  API keys: 3 API keys wait since a restore" in examined
    assert rundown("key", "confirm", "--database", target).returncode == 1
    assert "no key 'abcdefgh' is known" in rundown("key", "confirm", "abcdefgh", "--database", target).stderr
    assert rundown("key", "confirm", prefixes[0], "--database", target).stdout == f"{prefixes[0]} confirmed\n"
    assert rundown("key", "confirm", "--all", "--database", target).stdout == f"{prefixes[1]}, {prefixes[2]} confirmed\n"
    assert opening(target, made) == set(made)
