"""Backup and restore: a file with all data as of one moment, and beside it what it is, `<file>.json`.

Of SQLite the file is a database of its own, made by SQLite's backup API while others read and write; of PostgreSQL it is an
archive of `pg_dump`. What stands beside it is written last: a backup without it is not complete.
"""

import errno
import hashlib
import json
import os
import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from sqlalchemy import Engine
from sqlalchemy.exc import DatabaseError, DBAPIError, OperationalError

from storage import postgresql_archive
from storage.claim import Claim, DatabaseUnusable, file_of
from storage.database import engine_of, shown
from storage.private_files import PRIVATE
from storage.schema import KEPT_BY_ITSELF, require_known, revision_of, row_counts
from storage.tables import Base

FORMAT = 1
_PIECE = 1 << 20
_NEVER = "a backup never replaces another one"


class BackupUnusable(RuntimeError):
    """A backup cannot be made or restored; the message says why and what would help."""


@dataclass(frozen=True)
class Backup:
    """What a backup is. made_at: RFC 3339; rows: of each table."""

    format: int
    kind: str
    schema_revision: str
    made_at: str
    size: int
    sha256: str
    rows: dict[str, int]


def back_up(url: str, file: Path) -> Backup:
    """Copy a database as of one moment into a new file. Others may read and write meanwhile.

    Raises BackupUnusable, DatabaseUnusable.
    """
    if not file.name:
        raise BackupUnusable(f"{file} is no name of a file")
    part = file.with_name(file.name + ".part")
    try:
        for path in (file, described_by(file)):
            if path.exists():
                raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), str(path))
        with _engine(url) as engine, _new(part):
            moment = datetime.now(UTC)
            if engine.dialect.name == "sqlite":
                revision, rows = _copy_sqlite(engine, part)
            else:
                revision, rows = _dump_postgresql(engine, part)
            digest = _synced_digest(part)
            size = part.stat().st_size
            made = Backup(FORMAT, engine.dialect.name, revision, moment.isoformat(timespec="seconds"), size, digest, rows)
            _put_down(part, file, made)
    except FileExistsError as error:
        why = "another backup is being written to it; if none is, take it away" if error.filename == str(part) else _NEVER
        raise BackupUnusable(f"{error.filename} exists already: {why}") from error
    except (OSError, sqlite3.Error, postgresql_archive.ToolFailed) as error:
        raise BackupUnusable(f"{file} cannot be written: {error}") from error
    return made


def read(file: Path) -> Backup:
    """What a backup is, its checksum verified. Raises BackupUnusable."""
    try:
        values: dict[str, Any] = json.loads(described_by(file).read_text())
        found = Backup(**values)
        digest = _synced_digest(file)
    except (OSError, ValueError, TypeError) as error:
        raise BackupUnusable(f"{file} is no backup: {error}") from error
    if found.format != FORMAT:
        raise BackupUnusable(f"{file} is a backup of format {found.format}, not {FORMAT}")
    if digest != found.sha256:
        raise BackupUnusable(f"{file} is damaged: its SHA-256 is {digest}, {described_by(file).name} says {found.sha256}")
    return found


def restore(url: str, file: Path, *, overwrite: bool = False) -> Backup:
    """Put a backup in the place of a database that holds no data, or of any one with `overwrite`.

    All of it is there in the end, or what was there before. Raises BackupUnusable, DatabaseUnusable; also while a service
    uses the database.
    """
    found = read(file)
    require_known(found.schema_revision, str(file))
    with _engine(url) as engine:
        if engine.dialect.name != found.kind:
            raise BackupUnusable(
                f"{file} is a backup of {found.kind}, {shown(url)} is of {engine.dialect.name}: restore it to a database of "
                "its own kind, then take it over with `rundown move`"
            )
        claim = Claim(engine)
        try:
            claim.take()
            if not overwrite:
                _require_empty(engine, url)
            if engine.dialect.name == "sqlite":
                _replace_sqlite(engine, file, found)
            else:
                _replace_postgresql(engine, file, found)
        except (OSError, sqlite3.Error, postgresql_archive.ToolFailed) as error:
            raise BackupUnusable(f"{file} cannot be restored: {error}") from error
        finally:
            claim.release()
    return found


def described_by(file: Path) -> Path:
    """What stands beside a backup."""
    return file.with_name(file.name + ".json")


@contextmanager
def _engine(url: str) -> Iterator[Engine]:
    engine = engine_of(url)
    try:
        yield engine
    except DBAPIError as error:
        raise DatabaseUnusable(f"database {shown(url)} cannot be used: {error.orig}") from error
    finally:
        engine.dispose()


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
            f"database {shown(url)} is damaged ({error.orig}): say --overwrite to replace it, or restore to another one"
        ) from error
    if held:
        raise BackupUnusable(
            f"database {shown(url)} holds {held} rows: say --overwrite to lose them, or restore to another one"
        )


# --- SQLite ---------------------------------------------------------------------------------------------------------


def _copy_sqlite(engine: Engine, part: Path) -> tuple[str, dict[str, int]]:
    path = file_of(engine)
    if path is None or not path.is_file():
        raise DatabaseUnusable(f"there is no database file {path}")
    with (
        closing(sqlite3.connect(f"file:{path}?mode=ro", uri=True)) as source,
        closing(sqlite3.connect(part, isolation_level=None)) as target,
    ):
        # All pages in one step: a state between two commits, while writers go on in the write-ahead log.
        source.backup(target, pages=-1)
        target.execute("PRAGMA journal_mode = DELETE")
        (verdict,) = target.execute("PRAGMA integrity_check(1)").fetchone()
    if verdict != "ok":
        raise BackupUnusable(f"the database is damaged: {verdict}")
    return _content(f"sqlite:///{part}", str(path))


def _content(url: str, name: str) -> tuple[str, dict[str, int]]:
    with _engine(url) as engine, engine.connect() as connection:
        return require_known(revision_of(connection), name), row_counts(connection)


def _replace_sqlite(engine: Engine, file: Path, found: Backup) -> None:
    path = file_of(engine)
    if path is None:
        raise BackupUnusable("a database in memory cannot be restored")
    part = path.with_name(path.name + ".restoring")
    try:
        digest = hashlib.sha256()
        part.unlink(missing_ok=True)  # of a restore that was killed: whoever has the claim is the only one
        part.touch(mode=PRIVATE, exist_ok=False)
        with file.open("rb") as source, part.open("wb") as target:
            while piece := source.read(_PIECE):
                digest.update(piece)
                target.write(piece)
        if digest.hexdigest() != found.sha256:
            raise BackupUnusable(f"{file} changed while it was read")
        _require_whole(part, file, found)
        _synced_digest(part)
        engine.dispose()
        if path.exists():
            _end_log(path)
        # Before the new file is there: who dies in between leaves an old database, never a new one beside an old log, which
        # SQLite would play back into it.
        _remove_beside(path)
        _sync_folder(path.parent)
        part.replace(path)
        _sync_folder(path.parent)
        _require_whole(path, file, found)
    finally:
        part.unlink(missing_ok=True)
        _remove_beside(part)


def _end_log(path: Path) -> None:
    """Take what an old database has in its log over into its file, which is then whole by itself. One that is damaged stays
    as it is. Raises sqlite3.OperationalError while somebody uses it.
    """
    try:
        with closing(sqlite3.connect(path)) as old:
            old.execute("PRAGMA wal_checkpoint(TRUNCATE)")
            old.execute("PRAGMA journal_mode = DELETE")
    except sqlite3.DatabaseError as error:
        if error.sqlite_errorcode & 0xFF in (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED):
            raise


def _beside(path: Path) -> list[Path]:
    """Logs of a database file, also of one that is no longer there."""
    return [path.with_name(path.name + end) for end in ("-wal", "-shm", "-journal")]


def _remove_beside(path: Path) -> None:
    for one in _beside(path):
        one.unlink(missing_ok=True)


def _require_whole(path: Path, file: Path, found: Backup) -> None:
    """Raises BackupUnusable where a database file is not what a backup says of itself."""
    try:
        revision, rows = _content(f"sqlite:///{path}", str(path))
    except DatabaseUnusable as error:
        raise BackupUnusable(f"{file} was not restored whole: {error}") from error
    if revision != found.schema_revision:
        raise BackupUnusable(
            f"{file} was not restored whole: {path} has schema revision {revision}, the backup {found.schema_revision}"
        )
    _require_rows(rows, file, found)


# --- PostgreSQL -----------------------------------------------------------------------------------------------------


def _dump_postgresql(engine: Engine, part: Path) -> tuple[str, dict[str, int]]:
    """Counted and dumped in one snapshot."""
    with engine.connect().execution_options(isolation_level="REPEATABLE READ") as connection:
        revision = require_known(revision_of(connection), "the database")
        rows = row_counts(connection)
        postgresql_archive.dump(connection, part)
    return revision, rows


def _replace_postgresql(engine: Engine, file: Path, found: Backup) -> None:
    with postgresql_archive.set_aside(engine):
        postgresql_archive.load(engine, file)
        with engine.connect() as connection:
            rows = row_counts(connection)
        _require_rows(rows, file, found)


def _require_rows(rows: dict[str, int], file: Path, found: Backup) -> None:
    # A release may have let go of a table that the one that made the backup had.
    known = found.rows.keys() & Base.metadata.tables.keys() - KEPT_BY_ITSELF
    wrong = [name for name in sorted(known) if rows.get(name) != found.rows[name]]
    if wrong:
        raise BackupUnusable(f"{file} was not restored whole: {', '.join(wrong)} differ in their number of rows")


# --- files ----------------------------------------------------------------------------------------------------------


@contextmanager
def _new(path: Path) -> Iterator[None]:
    """A new file, empty and private, which goes again when what is done with it fails. Raises FileExistsError."""
    path.touch(mode=PRIVATE, exist_ok=False)
    try:
        yield
    except BaseException:
        path.unlink(missing_ok=True)
        raise


def _put_down(part: Path, file: Path, made: Backup) -> None:
    """Give a backup its name, and write beside it what it is. Raises FileExistsError where somebody was faster."""
    with _new(file):  # so that what is replaced is our own; links, which would do it in one step, not every disk has
        part.replace(file)
        with _new(described_by(file)):
            described_by(file).write_text(json.dumps(asdict(made), indent=1) + "\n")
            _synced_digest(described_by(file))
            _sync_folder(file.parent)


def _synced_digest(file: Path) -> str:
    """SHA-256 of a file, which is on the disk afterwards."""
    with file.open("rb") as opened:
        os.fsync(opened.fileno())
        return hashlib.file_digest(opened, "sha256").hexdigest()


def _sync_folder(folder: Path) -> None:
    """So that a file's new name is on the disk."""
    number = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(number)
    finally:
        os.close(number)
