"""The database: opening it, bringing its schema up to date, and transactions."""

import fcntl
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TextIO

import alembic.command
import alembic.config
from alembic.util.exc import CommandError
from sqlalchemy import Connection, Engine, create_engine, event, func, make_url, select
from sqlalchemy.exc import ArgumentError, DBAPIError, NoSuchModuleError
from sqlalchemy.orm import Session, sessionmaker

MIGRATIONS = Path(__file__).with_name("migrations")
BUSY_TIMEOUT_MS = 15_000
CLAIM_KEY = 0x52554E444F574E
"""Number of the advisory lock that a service holds on a PostgreSQL database."""


class DatabaseUnusable(RuntimeError):
    """The database cannot be opened or brought up to date; the message says which and why."""


class Database:
    """One database, SQLite or PostgreSQL by URL."""

    def __init__(self, url: str) -> None:
        """Open and migrate. Raises DatabaseUnusable."""
        try:
            self.engine = _engine(url)
        except (ArgumentError, NoSuchModuleError, ModuleNotFoundError) as error:
            raise DatabaseUnusable(f"database {_shown(url)} cannot be used: {error}") from error
        try:
            self._migrate()
        except (DBAPIError, CommandError, OSError) as error:
            self.engine.dispose()
            raise DatabaseUnusable(f"database {_shown(url)} cannot be used: {_cause(error)}") from error
        path = self._file()
        self._inode = path.stat().st_ino if path is not None else None
        self._claim: Connection | None = None
        self._lock: TextIO | None = None
        self._reading = sessionmaker(self.engine, expire_on_commit=False)
        self._writing = sessionmaker(self.engine.execution_options(writing=True), expire_on_commit=False)

    @contextmanager
    def transaction(self) -> Iterator[Session]:
        """A session whose changes are committed together at the end, or not at all."""
        with self._writing.begin() as session:
            yield session

    @contextmanager
    def reading(self) -> Iterator[Session]:
        """A session for looking only."""
        with self._reading() as session:
            yield session

    def claim(self) -> None:
        """Be the only service on this database until `close`. Raises DatabaseUnusable when another one is."""
        held = f"database {self.engine.url!r} is in use by another service: stop that one first"
        if self.engine.dialect.name == "postgresql":
            self._claim = self.engine.connect()
            if not self._claim.scalar(select(func.pg_try_advisory_lock(CLAIM_KEY))):
                raise DatabaseUnusable(held)
        elif (path := self._file()) is not None:
            self._lock = path.with_name(path.name + ".lock").open("w")
            try:
                fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError as error:
                self._lock.close()
                raise DatabaseUnusable(held) from error

    def check(self) -> None:
        """Raises DatabaseUnusable when the database does not answer, or its file is no longer there."""
        path = self._file()
        if path is not None and (not path.is_file() or path.stat().st_ino != self._inode):
            raise DatabaseUnusable(f"the database file {path} was deleted or replaced: restart the service")
        try:
            with self.reading() as session:
                session.execute(select(1))
        except DBAPIError as error:
            raise DatabaseUnusable(f"the database does not answer: {error.orig}") from error

    def close(self) -> None:
        """Give back all connections and the claim."""
        if self._claim is not None:
            self._claim.close()
        if self._lock is not None:
            self._lock.close()
        self.engine.dispose()

    def _file(self) -> Path | None:
        """The file of an SQLite database."""
        name = self.engine.url.database
        return Path(name) if self.engine.dialect.name == "sqlite" and name and name != ":memory:" else None

    def _migrate(self) -> None:
        config = alembic.config.Config()
        config.set_main_option("script_location", str(MIGRATIONS))
        # Under the writer's lock: several processes may open a new database at once.
        with self.engine.execution_options(writing=True).begin() as connection:
            config.attributes["connection"] = connection
            alembic.command.upgrade(config, "head")


def _cause(error: Exception) -> str:
    if isinstance(error, CommandError):
        return f"its schema is of another version of Rundown, probably a newer one: {error}"
    return str(error.orig if isinstance(error, DBAPIError) else error)


def _shown(url: str) -> str:
    try:
        return make_url(url).render_as_string(hide_password=True)
    except ArgumentError:
        return repr(url)


def _engine(url: str) -> Engine:
    engine = create_engine(url, pool_pre_ping=True)
    if engine.dialect.name == "sqlite":
        event.listen(engine, "connect", _configure_sqlite)
        event.listen(engine, "begin", _begin_sqlite)
    return engine


def _configure_sqlite(connection: Any, _record: Any) -> None:
    # Transactions are begun by `_begin_sqlite`: the driver's own handling starts them too late for a safe upgrade to writing.
    connection.isolation_level = None
    try:
        connection.execute(f"PRAGMA busy_timeout = {BUSY_TIMEOUT_MS}")
        connection.execute("PRAGMA journal_mode = WAL")
        # A sample is durable before it counts as received, also when the power fails.
        connection.execute("PRAGMA synchronous = FULL")
        connection.execute("PRAGMA foreign_keys = ON")
    except Exception:
        connection.close()  # nobody else knows of it yet
        raise


def _begin_sqlite(connection: Any) -> None:
    # A writer takes its lock at once: one that upgrades a read lock later may fail without the busy timeout being tried.
    connection.exec_driver_sql("BEGIN IMMEDIATE" if connection.get_execution_options().get("writing") else "BEGIN")
