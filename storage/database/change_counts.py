"""What tells that something was committed: a count of each table's changes, or the store's own mark of what is visible.

SQLite: triggers count the rows written, inside the writer's transaction, so that whoever sees a change sees its count,
whichever process wrote it; reading the counts takes microseconds. PostgreSQL: counting rows would make writers wait for each
other; instead its snapshot is asked for, which differs as soon as any transaction has committed.
"""

import sqlite3
import threading
import weakref
from collections.abc import Hashable, Sequence
from typing import cast

from sqlalchemy import text

from storage.database.engine import Database

WATCHED = (
    "machines",
    "machine_revisions",
    "collectors",
    "runs",
    "identifications",
    "estimates",
    "derived_quantities",
    "baselines",
    "timeline",
    "alerts",
    "alert_events",
)
"""Tables whose changes are counted; a migration that makes one anew has to make its triggers anew."""
WRITES = ("INSERT", "UPDATE", "DELETE")


def trigger_name(table: str, write: str) -> str:
    """Name of the trigger that counts one kind of write to a table."""
    return f"count_{write.lower()}_{table}"


class Changes:
    """Marks of what is committed. waits: whether asking for one waits for another process; then it belongs into a thread."""

    def __init__(self, database: Database) -> None:
        self._database = database
        self.waits = database.engine.dialect.name != "sqlite"
        self._connection: sqlite3.Connection | None = None
        self._version: int | None = None
        self._counts: dict[str, int] = {}
        self._lock = threading.Lock()

    def mark(self, tables: Sequence[str]) -> Hashable | None:
        """Differs from an earlier one as soon as something was committed to one of the tables; None where it is not known.

        What is read after it was asked for holds all that it stands for, or more. Raises DBAPIError.
        """
        if self.waits:
            with self._database.reading() as session:
                return cast(str, session.scalar(text("SELECT CAST(pg_current_snapshot() AS TEXT)")))
        with self._lock:
            try:
                counts = self._counted(self._opened())
            except sqlite3.DatabaseError:
                return None  # locked for a moment, for which nobody should wait here; or damaged, which who reads is told
        return tuple(counts[table] for table in tables)

    def _counted(self, connection: sqlite3.Connection) -> dict[str, int]:
        """Changes of each table. They are read only after a commit of somebody, of which SQLite knows by one number: with each
        row that it reads, this thread lets another one of the interpreter compute, and waits for its turn again.
        """
        (version,) = connection.execute("PRAGMA data_version").fetchone()
        if version != self._version:
            self._counts = dict(connection.execute("SELECT table_name, count FROM change_counts").fetchall())
            self._version = version
        return self._counts

    def _opened(self) -> sqlite3.Connection:
        """A connection outside the pool, on which each statement sees what is committed when it begins."""
        if self._connection is None:
            self._connection = self._database.own_connection(timeout=0.0, isolation_level=None, check_same_thread=False)
            weakref.finalize(self, self._connection.close)
        return self._connection
