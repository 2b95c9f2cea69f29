"""The claim on a database. Services hold it, on PostgreSQL several may share it; whoever replaces the data holds it alone."""

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
from storage.files import file_lock
from storage.files.private_files import PRIVATE

CLAIM_KEY = 0x52554E444F574E
"""Key of the advisory lock that is held on a PostgreSQL database."""
PATIENCE_S, LOOK_S = 2.0, 0.1
"""Time for which, and interval at which [s], a claim is retried: a server notices late that a claim's holder was killed."""


class DatabaseUnusable(Unavailable):
    """The database cannot be opened, claimed or upgraded; the message names it and the cause."""

    def __init__(self, message: str, *, outline: str = "the service's log says why") -> None:
        """Set up. outline: the cause without the database's place, for callers, who may be anybody."""
        super().__init__(message)
        self._outline = outline

    @property
    def detail(self) -> str:
        """Return the cause without the database's place."""
        return self._outline


class Claim:
    """A claim on a database: a lock file beside an SQLite file and a lock on the file itself, or an advisory lock of
    PostgreSQL.

    All of these end with the process.
    """

    def __init__(self, engine: Engine) -> None:
        self._engine = engine
        self._shared = self._lost = False
        self._connection: Connection | None = None
        self._held: set[tuple[int, int]] = set()
        self._file: TextIO | None = None
        self._made: Path | None = None
        """The lock file, where this claim has made it and takes it away again."""
        self._place: file_lock.FileIdentity | None = None
        self._lock = threading.Lock()

    def acquire(self, *, shared: bool = False) -> None:
        """Take the claim; raise DatabaseUnusable when another process holds it or, where `shared`, holds it alone."""
        held = f"database {self._engine.url!r} is in use by another service: stop that one first"
        self._shared = shared
        if self._engine.dialect.name == "postgresql":
            # Outside of any transaction: one that never ends would prevent the server's vacuum.
            self._connection = self._engine.connect().execution_options(isolation_level="AUTOCOMMIT")
            lock = func.pg_try_advisory_lock_shared if shared else func.pg_try_advisory_lock
            until = time.monotonic() + PATIENCE_S
            while not self._connection.scalar(select(lock(CLAIM_KEY))):
                if time.monotonic() >= until:
                    self.release()
                    raise DatabaseUnusable(held)
                time.sleep(LOOK_S)
        elif (path := file_of(self._engine)) is not None:
            try:
                self._lock_beside(_lock_path(path))
                if path.is_file():
                    self._place = file_lock.acquire(path)
            except BlockingIOError as error:
                self.release()
                raise DatabaseUnusable(held) from error
            except OSError as error:
                self.release()
                raise DatabaseUnusable(f"database {self._engine.url!r} cannot be claimed: {error}") from error

    def _lock_beside(self, beside: Path) -> None:
        """Lock the lock file, made if there is none. Raises BlockingIOError, OSError."""
        while True:
            made = not beside.exists()
            beside.touch(mode=PRIVATE)  # whoever may read the lock file may lock it
            self._file = beside.open("w")
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if _is_at(self._file, beside):
                self._made = beside if made else None
                return
            self._file.close()  # another claim has just taken it away

    def reacquire(self) -> None:
        """Take the claim again when the server was restarted and has lost it. Raises DatabaseUnusable, DBAPIError."""
        with self._lock:
            self._renew()

    def hold_lock(self, number: int, second: int) -> bool:
        """Hold a further PostgreSQL lock as long as the claim; return False while another connection holds it.

        That connection may be an earlier one of this process which the server has not given up yet. Raises DatabaseUnusable,
        DBAPIError.
        """
        with self._lock:
            self._renew()
            if self._connection is None or (number, second) in self._held:
                return True
            if not self._connection.scalar(select(func.pg_try_advisory_lock(number, second))):
                return False
            self._held.add((number, second))
            return True

    def _renew(self) -> None:
        if not self._lost and self._connection is None:
            return  # never taken, or the claim on a file
        try:
            if self._connection is not None:
                self._connection.execute(select(1))
                return
        except (DBAPIError, PendingRollbackError):  # broken now, or since it was last used
            self.release()
        self._lost = True  # stays set until the claim is taken again
        self.acquire(shared=self._shared)
        self._lost = False

    def release(self) -> None:
        """Release the claim and all further locks."""
        if self._connection is not None:
            with contextlib.suppress(DBAPIError, PendingRollbackError):  # broken: then the server releases it by itself
                self._connection.execute(select(func.pg_advisory_unlock_all()))
            # Returned to the pool, the connection would keep what the server has not released.
            self._connection.invalidate()
            self._connection.close()
            self._connection = None
        self._held.clear()
        if self._place is not None:
            file_lock.release(self._place)
            self._place = None
        if self._file is not None:
            if self._made is not None:  # before it is unlocked: nobody else's is taken away
                with contextlib.suppress(OSError):
                    self._made.unlink()
                self._made = None
            self._file.close()
            self._file = None


def file_of(engine: Engine) -> Path | None:
    """Return the file of an SQLite database with links resolved, as SQLite places its log beside it; None without a file."""
    name = engine.url.database
    return Path(os.path.realpath(name)) if engine.dialect.name == "sqlite" and name and name != ":memory:" else None


def without_folder(engine: Engine, text: str) -> str:
    """Return a text without the folder of an SQLite file, for whoever need not know where it lies."""
    path = file_of(engine)
    return text if path is None else text.replace(f"{path.parent}/", "")


def in_use(path: Path) -> bool:
    """Return whether another process has the claim on an SQLite file, under whatever name. Raises OSError."""
    return path.is_file() and file_lock.held_by_another(path)


def require_own_name(path: Path) -> None:
    """Raise DatabaseUnusable when the path is another name of an SQLite file that a service has open.

    SQLite would look for the log beside that name: it would miss the data in the real log, or write a second one. Raises
    OSError.
    """
    if not path.is_file():
        return
    ours = file_lock.holder(path)
    if (ours is not None and ours != path) or (ours is None and file_lock.held_by_another(path) and not _is_locked(path)):
        raise DatabaseUnusable(
            f"{path} is another name of a file that a service uses: take the name that the service has for it"
        )


def require_logs(path: Path) -> None:
    """Raise DatabaseUnusable when another process has claimed an SQLite file and one of its logs is missing.

    Opening the file would create a second log, and what is written to it would be lost. Raises OSError.
    """
    if path.is_file() and file_lock.holder(path) is None and (missing := missing_logs(path)) and in_use(path):
        raise DatabaseUnusable(
            f"{missing[0]} is missing though a service uses {path}: stop it cleanly, which saves all it has"
        )


def missing_logs(path: Path) -> list[Path]:
    """Return the logs of an open store that do not exist."""
    return [one for one in logs_of(path) if not one.exists()]


def logs_of(path: Path) -> list[Path]:
    """Return the paths of the files that SQLite keeps beside the main file while a store is open."""
    return [path.with_name(path.name + end) for end in ("-wal", "-shm")]


def _is_locked(path: Path) -> bool:
    """Return whether somebody holds the lock file beside a database file."""
    try:
        with _lock_path(path).open() as file:
            fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except FileNotFoundError:
        return False
    return False


def _is_at(file: TextIO, path: Path) -> bool:
    """Return whether an open file still has the name by which it was opened."""
    try:
        return os.path.samestat(os.fstat(file.fileno()), path.stat())
    except FileNotFoundError:
        return False


def _lock_path(path: Path) -> Path:
    return path.with_name(path.name + ".lock")
