"""The writers' turn of one process: on SQLite one transaction writes at a time, and its commits end in a file that has a name.

Writers wait here and not in SQLite, in turn and until the checkpoint after a commit is over: see `storage.database.versions`.
PostgreSQL serialises its writers by itself.
"""

import threading
from collections.abc import Iterator
from contextlib import contextmanager

from sqlalchemy.exc import OperationalError

from storage.database.sqlite_files import SqliteFiles

BUSY_TIMEOUT_MS = 15_000
"""Time for which a writer waits for its turn."""
SAVING_TURN_S = 1.0
"""Time for which saving a deleted log waits for the writers' turn; it is tried again."""


class WriterTurn:
    """Mutual exclusion of the writers of an SQLite store; writers of PostgreSQL pass at once."""

    def __init__(self, files: SqliteFiles | None, *, alone: bool) -> None:
        """Set the store's files, if it has any. alone: whether one writes at a time."""
        self._files = files
        self._alone = alone
        self._lock = threading.Lock()

    @contextmanager
    def taken(self) -> Iterator[None]:
        """Hold the turn. Raises OperationalError after a timeout, or when a file of the store is missing."""
        if not self._alone:
            yield
        elif self._lock.acquire(timeout=BUSY_TIMEOUT_MS / 1000):
            try:
                with self._durably():
                    yield
            finally:
                self._lock.release()
        else:
            waited = TimeoutError(f"database is locked: another thread has written for {BUSY_TIMEOUT_MS / 1000:.0f} s")
            raise OperationalError(None, None, waited)

    def require_content(self) -> None:
        """Raise OperationalError when a file was overwritten or cut off; call it before a commit."""
        if self._files is not None:
            self._files.require_content()

    def save(self, files: SqliteFiles) -> None:
        """Save data whose file has lost its name, or was cut off, when the turn comes soon."""
        if not files.saved and self._lock.acquire(timeout=SAVING_TURN_S):
            try:
                files.save()
            finally:
                self._lock.release()

    @contextmanager
    def _durably(self) -> Iterator[None]:
        """Save what was committed to a deleted log before the commit is reported. Raises OperationalError.

        What was committed to a log that is cut off, or beside a foreign file, may be lost: it is not reported.
        """
        if self._files is None:
            yield
            return
        self._files.require()
        yield
        if not self._files.check() and not self._files.save():
            self._files.require()
        self._files.require_content()
