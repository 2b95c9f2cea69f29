"""Inspecting an SQLite file that nobody has open, without changing anything: no log is replayed, truncated or deleted."""

import sqlite3
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from sqlalchemy import Engine, create_engine
from sqlalchemy.exc import DatabaseError
from sqlalchemy.pool import NullPool

from storage.database.schema import revision_of

UNCHANGED = "mode=ro&immutable=1"
"""URI parameters by which SQLite uses neither locks nor logs."""
_STEPS = 10_000
"""Number of SQLite's virtual machine instructions between two looks at the clock."""


@contextmanager
def inspection_engine(path: Path) -> Iterator[Engine]:
    """Yield an engine for inspecting a file that nobody has open; an open one could be seen half written."""
    log = path.with_name(path.name + "-wal")
    # A log is read through an index of our own; without a log the file is opened as immutable, so that none is created.
    with _engine(path, UNCHANGED if not log.exists() or not log.stat().st_size else "mode=ro") as engine:
        yield engine


def revision_beside_a_service(path: Path) -> str | None:
    """Return the schema revision in the main file of a store that somebody has open, touching neither log nor lock.

    None when the revision is in the log only.
    """
    try:
        with _engine(path, UNCHANGED) as engine, engine.connect() as connection:
            return revision_of(connection)
    except DatabaseError:
        return None


@contextmanager
def _engine(path: Path, how: str) -> Iterator[Engine]:
    def connected() -> sqlite3.Connection:
        return sqlite3.connect(f"{path.as_uri()}?{how}", uri=True)

    engine = create_engine("sqlite://", creator=connected, poolclass=NullPool)
    try:
        yield engine
    finally:
        engine.dispose()


def damages(
    connection: sqlite3.Connection,
    *,
    within_s: float,
    thorough: bool = False,
    stopped: Callable[[], bool] = lambda: False,
) -> list[str] | None:
    """Return at most five findings of damaged pages; None when the time did not suffice or the check was stopped.

    thorough: also check that each index matches its table, which takes much longer.
    """
    until = time.monotonic() + within_s
    connection.set_progress_handler(lambda: time.monotonic() > until or stopped(), _STEPS)
    try:
        check = "integrity_check" if thorough else "quick_check"
        found = [str(row[0]) for row in connection.execute(f"PRAGMA {check}(5)")]
    except sqlite3.OperationalError as error:
        if error.sqlite_errorcode == sqlite3.SQLITE_INTERRUPT:
            return None
        raise
    except sqlite3.DatabaseError as error:  # not even that much can be read
        return [str(error)]
    finally:
        connection.set_progress_handler(None, 0)
    return [] if found == ["ok"] else [line for one in found for line in one.splitlines() if not line.startswith("***")]
