"""Copying an SQLite database file while others use it, and putting a copy in its place."""

import hashlib
import sqlite3
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

from sqlalchemy import URL, Engine

from storage.backup.backup_file import Backup, BackupUnusable, require_rows, sync_folder, synced_digest
from storage.backup.restored_access import KnownKey, RestoredAccess, amend, known_keys
from storage.database.claim import DatabaseUnusable, file_of, require_logs, require_own_name
from storage.database.damage import marker_of
from storage.database.engine import temporary_engine
from storage.database.schema import require_known, revision_of, row_counts
from storage.files.private_files import PRIVATE

_PIECE = 1 << 20
_PAGES_AT_ONCE = 4096


def copy(engine: Engine, part: Path, report: Callable[[int, int], None]) -> tuple[str, dict[str, int]]:
    """Write all committed data into an existing empty file. report: receives the numbers of pages done and to do.

    Returns the schema revision and the number of rows of each table. Raises BackupUnusable, DatabaseUnusable, sqlite3.Error.
    """
    path = file_of(engine)
    if path is None or not path.is_file():
        raise DatabaseUnusable(f"there is no database file {path}")
    require_own_name(path)
    require_logs(path)
    with (
        closing(sqlite3.connect(f"{path.as_uri()}?mode=ro", uri=True)) as source,
        closing(sqlite3.connect(part, isolation_level=None)) as target,
    ):
        # One state between two commits, while writers go on in the write-ahead log: that of a reading transaction around all.
        source.execute("BEGIN")
        source.execute("SELECT 1 FROM sqlite_master").fetchone()
        source.backup(target, pages=_PAGES_AT_ONCE, progress=lambda _, left, total: report(total - left, total))
        source.rollback()
        target.execute("PRAGMA journal_mode = DELETE")
        (verdict,) = target.execute("PRAGMA integrity_check(1)").fetchone()
    if verdict != "ok":
        raise BackupUnusable(f"the database is damaged: {verdict}")
    return _content(part, str(path))


def _content(file: Path, name: str) -> tuple[str, dict[str, int]]:
    with temporary_engine(URL.create("sqlite", database=str(file))) as engine, engine.connect() as connection:
        return require_known(revision_of(connection), name), row_counts(connection)


def replace(
    engine: Engine, file: Path, found: Backup, report: Callable[[int, int], None], *, without_keys: bool
) -> RestoredAccess:
    """Replace the database file by a backup; at any moment the file is the old one or the new one.

    report: receives the numbers of bytes copied and to copy.

    The caller must hold the claim. Returns the access that was withdrawn. Raises BackupUnusable, OSError, sqlite3.Error.
    """
    path = file_of(engine)
    if path is None:
        raise BackupUnusable("a database in memory cannot be restored")
    part = path.with_name(path.name + ".restoring")
    try:
        digest = hashlib.sha256()
        part.unlink(missing_ok=True)  # left by a killed restore: the claim's holder is the only user
        part.touch(mode=PRIVATE, exist_ok=False)
        with file.open("rb") as source, part.open("wb") as target:
            while piece := source.read(_PIECE):
                digest.update(piece)
                target.write(piece)
                report(target.tell(), found.size)
        if digest.hexdigest() != found.sha256:
            raise BackupUnusable(f"{file} changed while it was read")
        _require_whole(part, file, found)
        engine.dispose()
        if path.exists():
            _end_log(path)
        access = _amended(part, _keys_of(path), without_keys=without_keys)
        content = _content(part, str(part))
        synced_digest(part)
        # Before the new file is in place: a crash in between leaves an old database, never a new one beside an old log, which
        # SQLite would replay into it.
        _remove_companions(path)
        sync_folder(path.parent)
        part.replace(path)
        sync_folder(path.parent)
        if _content(path, str(path)) != content:
            raise BackupUnusable(f"{file} was not restored whole: {path} does not hold what was written to it")
    finally:
        part.unlink(missing_ok=True)
        _remove_companions(part)
    return access


def _keys_of(path: Path) -> dict[str, KnownKey]:
    """Return the keys of the database that is to be replaced; none when it cannot be read or does not exist."""
    if not path.exists():
        return {}
    try:
        with temporary_engine(URL.create("sqlite", database=str(path))) as engine, engine.connect() as connection:
            return known_keys(connection)
    except DatabaseUnusable:
        return {}


def _amended(part: Path, known: dict[str, KnownKey], *, without_keys: bool) -> RestoredAccess:
    with (
        temporary_engine(URL.create("sqlite", database=str(part))) as engine,
        engine.execution_options(writing="alone").begin() as connection,
    ):
        return amend(connection, known, without_keys=without_keys)


def _end_log(path: Path) -> None:
    """Move the contents of an old database's log into its file, so that the file is complete by itself.

    A damaged database is left as it is. Raises sqlite3.OperationalError while somebody uses it.
    """
    try:
        with closing(sqlite3.connect(path)) as old:
            old.execute("PRAGMA wal_checkpoint(TRUNCATE)")
            old.execute("PRAGMA journal_mode = DELETE")
    except sqlite3.DatabaseError as error:
        if error.sqlite_errorcode & 0xFF in (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED):
            raise


def _companion_files(path: Path) -> list[Path]:
    """Return the paths of a database file's logs and of its damage marker; the file itself need not exist."""
    return [*(path.with_name(path.name + end) for end in ("-wal", "-shm", "-journal")), marker_of(path)]


def _remove_companions(path: Path) -> None:
    for one in _companion_files(path):
        one.unlink(missing_ok=True)


def _require_whole(path: Path, file: Path, found: Backup) -> None:
    """Raise BackupUnusable unless a database file matches the description of its backup."""
    try:
        revision, rows = _content(path, str(path))
    except DatabaseUnusable as error:
        raise BackupUnusable(f"{file} was not restored whole: {error}") from error
    if revision != found.schema_revision:
        raise BackupUnusable(
            f"{file} was not restored whole: {path} has schema revision {revision}, the backup {found.schema_revision}"
        )
    require_rows(rows, file, found)
