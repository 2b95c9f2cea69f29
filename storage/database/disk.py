"""Disk space: how much the data take, how much is left, and returning free pages of an SQLite file to the file system."""

import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sqlalchemy import Connection, func, select

from storage.database.claim import file_of
from storage.database.engine import Database

INCREMENTAL = 2
"""SQLite's number for the kind of vacuum that new files use."""
PAGES_AT_ONCE = 2_000
"""Free pages that are returned in one transaction."""


@dataclass(frozen=True)
class DiskUse:
    """Disk space in bytes. data: size of the database with its log; free, total: free and total space of its file system, None
    when that is on another machine; budget: the largest allowed size, None without a limit."""

    data: int
    free: int | None
    total: int | None
    budget: int | None

    @property
    def part(self) -> float | None:
        """Return the used part of the space, from 0 to 1, of the budget or of the file system, whichever is fuller.

        None when neither is known.
        """
        parts = []
        if self.budget:
            parts.append(self.data / self.budget)
        if self.free is not None and self.total:
            parts.append(1.0 - self.free / self.total)
        return max(parts, default=None)


def used(database: Database, *, budget: int | None) -> DiskUse:
    """Return the disk space that a database takes. Raises DBAPIError, OSError."""
    path = file_of(database.engine)
    if path is not None:
        return used_by_file(path, budget=budget)
    if database.kind == "sqlite":
        return DiskUse(0, None, None, budget)
    with database.reading() as session:
        size = session.scalar(select(func.pg_database_size(func.current_database())))
    return DiskUse(int(size or 0), None, None, budget)


def used_by_file(path: Path, *, budget: int | None) -> DiskUse:
    """Return the disk space that an SQLite file takes, without opening it. Raises OSError."""
    files = (path, path.with_name(path.name + "-wal"))
    room = shutil.disk_usage(path.parent)
    return DiskUse(sum(one.stat().st_size for one in files if one.exists()), room.free, room.total, budget)


def release_free_pages(database: Database) -> int:
    """Return some free pages of an SQLite file to the file system; return their number.

    PostgreSQL reuses free space by itself (autovacuum). An SQLite file from an older release reuses it too, but keeps its
    size.
    """
    if database.kind != "sqlite":
        return 0
    with database.reading() as session:
        connection = session.connection()
        if not _free_pages(connection) or connection.exec_driver_sql("PRAGMA auto_vacuum").scalar() != INCREMENTAL:
            return 0
    with database.transaction() as session:
        connection = session.connection()
        free = _free_pages(connection)
        driver: Any = connection.connection.driver_connection
        # It goes on by a page with each row that is asked for, though it has none to show.
        driver.execute(f"PRAGMA incremental_vacuum({PAGES_AT_ONCE})").fetchall()
        return free - _free_pages(connection)


def _free_pages(connection: Connection) -> int:
    return int(connection.exec_driver_sql("PRAGMA freelist_count").scalar() or 0)
