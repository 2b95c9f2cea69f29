"""Looking into a database that may be another process's: nothing is created, migrated, written or checkpointed."""

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
    """A session for looking, of whatever revision the schema is. Raises DatabaseUnusable, also for what is asked in it."""
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
    """Of a file without its log nobody reads one: SQLite would make one, and leave it."""
    alone = not path.with_name(path.name + "-wal").exists()
    return f"{path.as_uri()}?mode=ro{'&immutable=1' if alone else ''}"
