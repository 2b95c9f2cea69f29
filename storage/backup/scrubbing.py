"""Erasing deleted data from an SQLite file: until their space is reused they remain in free pages and in the log."""

import shutil
import sqlite3
from contextlib import closing
from typing import Any

from sqlalchemy.exc import DBAPIError
from sqlalchemy.orm import Session

from storage.database.claim import file_of
from storage.database.engine import Database

LARGEST = 2 * 2**30
"""Largest file that is rewritten at a start [bytes]: a larger one would take minutes, and as much free space again."""


class ScrubFailed(RuntimeError):
    """Copies of deleted data may remain in the file; the message states the cause and the remedy."""


def overwrite_deleted(session: Session) -> None:
    """Overwrite with zeros whatever this session's transaction deletes or replaces. PostgreSQL has no equivalent."""
    connection = session.connection()
    if connection.dialect.name == "sqlite":
        connection.exec_driver_sql("PRAGMA secure_delete = ON")


def scrub(database: Database) -> None:
    """Rewrite an SQLite file without deleted data and truncate its log.

    The caller must be its only user. Raises ScrubFailed.
    """
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
