"""Backup and restore. A backup of SQLite is a database file, made by SQLite's backup API while others read and write; a backup
of PostgreSQL is an archive of `pg_dump`."""

import errno
import os
import sqlite3
from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from sqlalchemy import Engine
from sqlalchemy.exc import DatabaseError, OperationalError

from storage.backup import sqlite_copy
from storage.backup.backup_file import (
    FORMAT,
    Backup,
    BackupUnusable,
    description_path,
    finalise,
    new_file,
    read,
    require_rows,
    synced_digest,
)
from storage.backup.restored_access import KnownKey, RestoredAccess, amend, known_keys
from storage.database import postgresql_tools
from storage.database.claim import Claim, file_of
from storage.database.engine import redacted_url, temporary_engine
from storage.database.schema import require_known, revision_of, row_counts

_NEVER = "a backup never replaces another one"


def back_up(url: str, file: Path, report: Callable[[int, int], None] = lambda _done, _all: None) -> Backup:
    """Copy a database as of one moment into a new file, while others read and write.

    report: receives how much of how much is copied: pages of SQLite, rows of PostgreSQL, table by table.

    Raises BackupUnusable, DatabaseUnusable.
    """
    if not file.name:
        raise BackupUnusable(f"{file} is no name of a file")
    part = file.with_name(file.name + ".part")
    try:
        for path in (file, description_path(file)):
            if path.exists():
                raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), str(path))
        with temporary_engine(url) as engine, new_file(part):
            moment = datetime.now(UTC)
            if engine.dialect.name == "sqlite":
                revision, rows = sqlite_copy.copy(engine, part, report)
            else:
                revision, rows = _dump_postgresql(engine, part, report)
            digest = synced_digest(part)
            size = part.stat().st_size
            made = Backup(FORMAT, engine.dialect.name, revision, moment.isoformat(timespec="seconds"), size, digest, rows)
            finalise(part, file, made)
    except FileExistsError as error:
        why = "another backup is being written to it; if none is, take it away" if error.filename == str(part) else _NEVER
        raise BackupUnusable(f"{error.filename} exists already: {why}") from error
    except (OSError, sqlite3.Error, postgresql_tools.ToolFailed) as error:
        raise BackupUnusable(f"{file} cannot be written: {error}") from error
    return made


@dataclass(frozen=True)
class Restored:
    """The backup that was restored, and the access that was withdrawn after it."""

    backup: Backup
    access: RestoredAccess


def restore(
    url: str,
    file: Path,
    report: Callable[[int, int], None] = lambda _done, _all: None,
    *,
    overwrite: bool = False,
    without_keys: bool = False,
) -> Restored:
    """Replace an empty database, or any database with `overwrite`, by a backup.

    Either all of the backup is in place afterwards, or the old data. Access is not restored as it was: all sessions are logged
    out, keys that the replaced database has as revoked are revoked, and keys that it does not know wait for a confirmation
    (`storage.backup.restored_access`). A backup without any key replaces a database that has some only where
    `without_keys` is set: the service would be open to everybody.

    report: receives how much of how much is copied, as for `back_up`.

    Raises BackupUnusable, DatabaseUnusable; also while a service uses the database.
    """
    found = read(file)
    require_known(found.schema_revision, str(file))
    with temporary_engine(url) as engine:
        if engine.dialect.name != found.kind:
            raise BackupUnusable(
                f"{file} is a backup of {found.kind}, {redacted_url(url)} is of {engine.dialect.name}: restore it to a "
                "database of its own kind, then take it over with `rundown move`"
            )
        claim = Claim(engine)
        try:
            claim.acquire()
            if not overwrite:
                _require_empty(engine, url)
            if engine.dialect.name == "sqlite":
                access = sqlite_copy.replace(engine, file, found, report, without_keys=without_keys)
            else:
                access = _replace_postgresql(engine, file, found, report, without_keys=without_keys)
        except (OSError, sqlite3.Error, postgresql_tools.ToolFailed) as error:
            raise BackupUnusable(f"{file} cannot be restored: {error}") from error
        finally:
            claim.release()
    return Restored(found, access)


def _require_empty(engine: Engine, url: str) -> None:
    path = file_of(engine)
    if path is not None and not path.exists():
        return
    try:
        with engine.connect() as connection:
            held = sum(row_counts(connection).values())
    except OperationalError:
        raise
    except DatabaseError as error:
        raise BackupUnusable(
            f"database {redacted_url(url)} is damaged ({error.orig}): say --overwrite to replace it, or restore to another one"
        ) from error
    if held:
        raise BackupUnusable(
            f"database {redacted_url(url)} holds {held} rows: say --overwrite to lose them, or restore to another one"
        )


def _dump_postgresql(engine: Engine, part: Path, report: Callable[[int, int], None]) -> tuple[str, dict[str, int]]:
    """Count and dump the rows in one snapshot."""
    with engine.connect().execution_options(isolation_level="REPEATABLE READ") as connection:
        revision = require_known(revision_of(connection), "the database")
        rows = row_counts(connection)
        postgresql_tools.dump(connection, part, rows, report)
    return revision, rows


def _replace_postgresql(
    engine: Engine, file: Path, found: Backup, report: Callable[[int, int], None], *, without_keys: bool
) -> RestoredAccess:
    with postgresql_tools.set_aside(engine):
        postgresql_tools.load(engine, file, found.rows, report)
        with engine.connect() as connection:
            rows = row_counts(connection)
        require_rows(rows, file, found)
        with engine.begin() as connection:
            return amend(connection, _keys_aside(engine), without_keys=without_keys)


def _keys_aside(engine: Engine) -> dict[str, KnownKey]:
    """Return the keys of the replaced database; none when it cannot be read."""
    try:
        with engine.connect() as connection:
            return known_keys(connection, schema=postgresql_tools.ASIDE)
    except DatabaseError:
        return {}
