"""Taking out for good what was deleted from an SQLite file: it stays in free pages and in its log until they are reused."""

import shutil
import sqlite3
from contextlib import closing
from typing import Any

from sqlalchemy.exc import DBAPIError
from sqlalchemy.orm import Session

from storage.database.claim import file_of
from storage.database.engine import Database

LARGEST = 2 * 2**30
"""A larger file is not written anew at a start: it would take minutes, and as much room again [bytes]."""


class ScrubFailed(RuntimeError):
    """Copies may be left in the file; the message says why and what takes them out."""


def overwrite_deleted(session: Session) -> None:
    """Fill with zeros what this session's transaction deletes or replaces. PostgreSQL has nothing like it."""
    connection = session.connection()
    if connection.dialect.name == "sqlite":
        connection.exec_driver_sql("PRAGMA secure_delete = ON")


def scrub(database: Database) -> None:
    """Write an SQLite file anew without what was deleted, and cut its log. For who is alone with it. Raises ScrubFailed."""
    path = file_of(database.engine)
    if path is None:
        return
    by_hand = f"stop the service and run: sqlite3 {path} VACUUM"
    try:
        size = path.stat().st_size
        small = size <= LARGEST and 3 * size < shutil.disk_usage(path.parent).free
        with database.turn(), closing(database.engine.raw_connection()) as opened:
            driver: Any = opened.driver_connection
            if small:
                driver.execute("VACUUM")
            busy, _, _ = driver.execute("PRAGMA wal_checkpoint(TRUNCATE)").fetchone()
    except (DBAPIError, sqlite3.Error, OSError) as error:
        raise ScrubFailed(f"{path} could not be written anew ({error}): {by_hand}") from error
    finally:
        database.engine.dispose()  # its connections still overwrite what they delete
    if busy:
        raise ScrubFailed(f"another program reads {path}: {by_hand}")
    if not small:
        raise ScrubFailed(f"{path} is too large to be written anew at a start: {by_hand}")
