"""The claim on a database: services hold it, on PostgreSQL several share it; whoever replaces the data holds it alone."""

import contextlib
import fcntl
import os
import threading
import time
from pathlib import Path
from typing import TextIO

from sqlalchemy import Connection, Engine, func, select
from sqlalchemy.exc import DBAPIError, PendingRollbackError

from estimator.errors import Unavailable
from storage.database import file_lock
from storage.database.private_files import PRIVATE

CLAIM_KEY = 0x52554E444F574E
"""Number of the advisory lock that is held on a PostgreSQL database."""
PATIENCE_S, LOOK_S = 2.0, 0.1
"""A server takes a moment to notice that who held a claim was killed."""


class DatabaseUnusable(Unavailable):
    """The database cannot be opened, claimed or brought up to date; the message says which and why."""


class Claim:
    """A lock file beside an SQLite file and a lock on the file itself, an advisory lock on a PostgreSQL database; all of them
    end with the process.
    """

    def __init__(self, engine: Engine) -> None:
        self._engine = engine
        self._shared = self._lost = False
        self._connection: Connection | None = None
        self._held: set[tuple[int, int]] = set()
        self._file: TextIO | None = None
        self._place: file_lock.Place | None = None
        self._asking = threading.Lock()

    def take(self, *, shared: bool = False) -> None:
        """Raises DatabaseUnusable when another one holds it, where shared: alone."""
        held = f"database {self._engine.url!r} is in use by another service: stop that one first"
        self._shared = shared
        if self._engine.dialect.name == "postgresql":
            # Outside of any transaction: one that is never ended would keep the server from tidying up.
            self._connection = self._engine.connect().execution_options(isolation_level="AUTOCOMMIT")
            lock = func.pg_try_advisory_lock_shared if shared else func.pg_try_advisory_lock
            until = time.monotonic() + PATIENCE_S
            while not self._connection.scalar(select(lock(CLAIM_KEY))):
                if time.monotonic() >= until:
                    self.release()
                    raise DatabaseUnusable(held)
                time.sleep(LOOK_S)
        elif (path := file_of(self._engine)) is not None:
            beside = _beside(path)
            try:
                beside.touch(mode=PRIVATE)  # whoever may read it may hold it
                self._file = beside.open("w")
                fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                if path.is_file():
                    self._place = file_lock.take(path)
            except BlockingIOError as error:
                self.release()
                raise DatabaseUnusable(held) from error
            except OSError as error:
                self.release()
                raise DatabaseUnusable(f"database {self._engine.url!r} cannot be claimed: {error}") from error

    def keep(self) -> None:
        """Take it again where a server that was restarted has forgotten it. Raises DatabaseUnusable, DBAPIError."""
        with self._asking:
            self._keep()

    def hold(self, number: int, second: int) -> bool:
        """Hold a further lock of PostgreSQL as long as the claim; False where another connection does, if only one of ours
        that the server has not given up yet. Raises DatabaseUnusable, DBAPIError.
        """
        with self._asking:
            self._keep()
            if self._connection is None or (number, second) in self._held:
                return True
            if not self._connection.scalar(select(func.pg_try_advisory_lock(number, second))):
                return False
            self._held.add((number, second))
            return True

    def _keep(self) -> None:
        if not self._lost and self._connection is None:
            return  # never taken, or a file's
        try:
            if self._connection is not None:
                self._connection.execute(select(1))
                return
        except (DBAPIError, PendingRollbackError):  # broken now, or since it was last used
            self.release()
        self._lost = True  # until it is taken again, however often that fails
        self.take(shared=self._shared)
        self._lost = False

    def release(self) -> None:
        """Let go of it."""
        if self._connection is not None:
            with contextlib.suppress(DBAPIError, PendingRollbackError):  # broken: then the server lets go of it by itself
                self._connection.execute(select(func.pg_advisory_unlock_all()))
            # Given back to the pool, the connection would hold on what the server has not given up.
            self._connection.invalidate()
            self._connection.close()
            self._connection = None
        self._held.clear()
        if self._place is not None:
            file_lock.release(self._place)
            self._place = None
        if self._file is not None:
            self._file.close()
            self._file = None


def file_of(engine: Engine) -> Path | None:
    """The file of an SQLite database: the one to which links lead, and beside which SQLite puts its log."""
    name = engine.url.database
    return Path(os.path.realpath(name)) if engine.dialect.name == "sqlite" and name and name != ":memory:" else None


def in_use(path: Path) -> bool:
    """Whether another process has the claim on an SQLite file, by whatever name. Raises OSError."""
    return path.is_file() and file_lock.held_by_another(path)


def require_own_name(path: Path) -> None:
    """Raises DatabaseUnusable for another name of an SQLite file that a service has open: SQLite would look for its log beside
    that name, and find the data without it, or write a second one. Raises OSError.
    """
    if not path.is_file():
        return
    ours = file_lock.holder(path)
    if (ours is not None and ours != path) or (ours is None and file_lock.held_by_another(path) and not _is_locked(path)):
        raise DatabaseUnusable(
            f"{path} is another name of a file that a service uses: take the name that the service has for it"
        )


def require_logs(path: Path) -> None:
    """Raises DatabaseUnusable for an SQLite file that another process has the claim on, and of which a log is missing: who
    opens it then makes a second one, and what goes there is lost. Raises OSError.
    """
    if path.is_file() and file_lock.holder(path) is None and (missing := missing_logs(path)) and in_use(path):
        raise DatabaseUnusable(
            f"{missing[0]} is missing though a service uses {path}: stop it cleanly, which saves all it has"
        )


def missing_logs(path: Path) -> list[Path]:
    """Which of the logs of a store that is open are not there."""
    return [one for one in logs_of(path) if not one.exists()]


def logs_of(path: Path) -> list[Path]:
    """What SQLite puts beside the main file while a store is open."""
    return [path.with_name(path.name + end) for end in ("-wal", "-shm")]


def _is_locked(path: Path) -> bool:
    """Whether somebody has the lock file beside it."""
    try:
        with _beside(path).open() as file:
            fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except FileNotFoundError:
        return False
    return False


def _beside(path: Path) -> Path:
    return path.with_name(path.name + ".lock")
