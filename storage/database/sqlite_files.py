"""The files of an SQLite store that is open: whether they are still those that were opened, and saving what only they hold.

SQLite goes on with a log that was deleted, and nobody is told. Whoever opens the store then, or finds it after a kill, sees it
without all that is in that log. A checkpoint through a connection that is open still brings all of it into the main file.
"""

import sqlite3
import stat
import threading
from pathlib import Path

from sqlalchemy.exc import OperationalError

from storage.database.claim import DatabaseUnusable, logs_of

SAVING_MS = 1_000
"""How long a checkpoint waits for who reads."""


class SqliteFiles:
    """The main file, its log and the index of that, as they were opened. What is once gone stays gone until `close`."""

    def __init__(self, path: Path) -> None:
        """Open a connection that keeps them. Raises sqlite3.Error."""
        self._path = path
        self._keeper = sqlite3.connect(path, isolation_level=None, check_same_thread=False, timeout=SAVING_MS / 1000)
        try:
            self._keeper.execute("SELECT 1 FROM sqlite_master LIMIT 1").fetchone()  # opens the log
            self._keeper.execute("PRAGMA synchronous = FULL")
        except sqlite3.Error:
            self._keeper.close()
            raise
        self._opened = {one: _place(one) for one in (path, *logs_of(path))}
        self._asking = threading.Lock()
        self._gone: Path | None = None
        self._closed = False
        self.saved = False
        """Whether one is gone, and the main file holds all that was stored."""

    def look(self) -> bool:
        """Whether all are there still; costs microseconds."""
        if self._gone is None:
            # Closed, the main file is all there is.
            looked_at = [self._path] if self._closed else list(self._opened)
            self._gone = next((one for one in looked_at if _place(one) != self._opened[one]), None)
        return self._gone is None

    def require(self) -> None:
        """Raises OperationalError where one is gone: nothing is to be written then, and no connection opened, which would make
        a second log.
        """
        if (trouble := self.trouble) is not None:
            raise OperationalError(None, None, DatabaseUnusable(trouble))

    @property
    def trouble(self) -> str | None:
        """Which one is gone, and what to do."""
        if self.look():
            return None
        gone = f"{self._gone} was deleted or replaced while the service had it open"
        if self._gone == self._path:
            return f"the database file {gone}: restart the service"
        if self.saved:
            return f"{gone}. All that was acknowledged is saved in {self._path}; nothing more is stored: restart the service"
        return (
            f"{gone}, and what was stored last is not saved yet. Stop the service cleanly: that saves all. "
            f"Do not kill it, and do not open {self._path} with anything meanwhile"
        )

    def save(self) -> bool:
        """Bring all that was committed into the main file; returns whether it is there. For who has the writers' turn."""
        with self._asking:
            if not self.saved and not self._closed:
                try:
                    _, logged, done = self._keeper.execute("PRAGMA wal_checkpoint(TRUNCATE)").fetchone()
                except sqlite3.Error:
                    return False  # its disk is full, say: tried again
                self.saved = logged == done
            return self.saved

    def close(self) -> None:
        """Look no more. Of the last connection SQLite makes a checkpoint."""
        with self._asking:
            self._closed = True
            self._keeper.close()


def _place(file: Path) -> tuple[int, int] | None:
    try:
        found = file.stat()
    except OSError:
        return None
    return (found.st_dev, found.st_ino) if stat.S_ISREG(found.st_mode) else None
