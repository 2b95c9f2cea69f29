"""The turn of the writers of one process: on SQLite one writes at a time, and what it commits is in a file that has a name.

Writers wait here for each other and not in SQLite, in turn and until the checkpoint behind a commit is over: see
`storage.database.versions`. PostgreSQL orders them itself.
"""

import threading
from collections.abc import Iterator
from contextlib import contextmanager

from sqlalchemy.exc import OperationalError

from storage.database.sqlite_files import SqliteFiles

BUSY_TIMEOUT_MS = 15_000
"""How long a writer waits for its turn."""
SAVING_TURN_S = 1.0
"""How long the saving of a log that is gone waits for its turn among writers; it is tried again."""


class WriterTurn:
    """Lets one writer at a time at an SQLite store, and all at once at PostgreSQL."""

    def __init__(self, files: SqliteFiles | None, *, alone: bool) -> None:
        """Take the store's files, if it has any. alone: whether one writes at a time."""
        self._files = files
        self._alone = alone
        self._lock = threading.Lock()

    @contextmanager
    def taken(self) -> Iterator[None]:
        """Have the turn. Raises OperationalError where it does not come, or where a file of the store is gone."""
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

    def save(self, files: SqliteFiles) -> None:
        """Save what is in no file any more that has a name, if the turn comes soon."""
        if not files.saved and self._lock.acquire(timeout=SAVING_TURN_S):
            try:
                files.save()
            finally:
                self._lock.release()

    @contextmanager
    def _durably(self) -> Iterator[None]:
        """Save what is committed to a log that is gone before anybody counts on it. Raises OperationalError."""
        if self._files is None:
            yield
            return
        self._files.require()
        yield
        if not self._files.look() and not self._files.save():
            self._files.require()
