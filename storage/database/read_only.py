"""Reading a database that may belong to another process: nothing is created, migrated, written or checkpointed."""

import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from sqlalchemy import create_engine
from sqlalchemy.exc import DBAPIError
from sqlalchemy.orm import Session

from storage.database.claim import DatabaseUnusable, file_of
from storage.database.engine import engine_of, redacted_url


@contextmanager
def read_only_session(url: str) -> Iterator[Session]:
    """Yield a session for reading, whatever revision the schema has.

    Raises DatabaseUnusable, also for errors of its queries.
    """
    engine = engine_of(url)
    path = file_of(engine)
    if path is not None:
        engine = create_engine("sqlite://", creator=lambda: sqlite3.connect(_address(path), uri=True))
    try:
        with Session(engine) as session:
            yield session
    except DBAPIError as error:
        raise DatabaseUnusable(f"database {redacted_url(url)} cannot be used: {error.orig}") from error
    finally:
        engine.dispose()


def _address(path: Path) -> str:
    """Return a read-only URI; immutable when there is no log, because SQLite would create one and leave it."""
    alone = not path.with_name(path.name + "-wal").exists()
    return f"{path.as_uri()}?mode=ro{'&immutable=1' if alone else ''}"
