"""Detecting that something was committed: by counts of each table's changes, or by PostgreSQL's snapshot.

SQLite: triggers count the written rows inside the writer's transaction. Whoever sees a change therefore sees its count,
whichever process wrote it, and reading the counts takes microseconds. PostgreSQL: counting rows would make writers wait for
each other; its current snapshot is read instead, which changes as soon as any transaction has committed.
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
"""Tables whose changes are counted; a migration that recreates one of them has to recreate its triggers."""
WRITES = ("INSERT", "UPDATE", "DELETE")


class Changes:
    """Marks of the committed state. waits: whether reading a mark waits for another process and belongs into a thread."""

    def __init__(self, database: Database) -> None:
        self._database = database
        self.waits = database.engine.dialect.name != "sqlite"
        self._connection: sqlite3.Connection | None = None
        self._version: int | None = None
        self._counts: dict[str, int] = {}
        self._lock = threading.Lock()

    def mark(self, tables: Sequence[str]) -> Hashable | None:
        """Return a mark that changes as soon as something is committed to one of the tables; None when it is unknown.

        Data read after the mark are at least as new as the mark. Raises DBAPIError.
        """
        if self.waits:
            with self._database.reading() as session:
                return cast(str, session.scalar(text("SELECT CAST(pg_current_snapshot() AS TEXT)")))
        with self._lock:
            try:
                counts = self._counted(self._open_connection())
            except sqlite3.DatabaseError:
                return None  # locked for a moment, and nobody should wait; or damaged, which the next read reports
        return tuple(counts[table] for table in tables)

    def close(self) -> None:
        """Close the connection; the next mark opens another one."""
        with self._lock:
            if self._connection is not None:
                self._connection.close()
            self._connection = self._version = None

    def _counted(self, connection: sqlite3.Connection) -> dict[str, int]:
        """Return the changes of each table.

        The counts are read again only when SQLite's data version shows that somebody has committed: for each row that it
        reads, this thread gives up the interpreter lock and waits to get it back.
        """
        (version,) = connection.execute("PRAGMA data_version").fetchone()
        if version != self._version:
            self._counts = dict(connection.execute("SELECT table_name, count FROM change_counts").fetchall())
            self._version = version
        return self._counts

    def _open_connection(self) -> sqlite3.Connection:
        """Return a connection outside the pool, each of whose statements sees what is committed when it begins."""
        if self._connection is None:
            self._connection = self._database.own_connection(timeout=0.0, isolation_level=None, check_same_thread=False)
            weakref.finalize(self, self._connection.close)
            self._database.followers.add(self)
        return self._connection
