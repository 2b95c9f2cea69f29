"""Databases of the tests of storage and service: copies of ones made once, as migrating takes its time.

RUNDOWN_TEST_DATABASE says which kind: `sqlite`, the default, or `postgresql`.
"""

import contextlib
import itertools
import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Literal, Protocol, get_args

from sqlalchemy import make_url

from storage.database.engine import Database
from tests.plant import sqlite_url
from tests.postgresql import PostgresServer, version

Kind = Literal["sqlite", "postgresql"]
KINDS: tuple[Kind, ...] = get_args(Kind)
KIND_ASKED_FOR = "RUNDOWN_TEST_DATABASE"
"""Environment variable that names a kind; unset, it is SQLite."""
NUMBERS = itertools.count(1)
"""Of databases: a server outlives those who make them."""
FIRST_WITH_STRATEGIES = 15
"""Version of PostgreSQL."""
NewDatabase = Callable[[str], Database]
"""A copy of a template, open until the test is over."""


def chosen() -> Kind:
    """Return the kind of database that was asked for."""
    name = os.environ.get(KIND_ASKED_FOR, "sqlite")
    for kind in KINDS:
        if kind == name:
            return kind
    raise ValueError(f"{KIND_ASKED_FOR} is '{name}'; it can be {' or '.join(KINDS)}")


class Databases(Protocol):
    """Makes databases of one kind; `path` is where it is, if it is a file."""

    def new(self, path: Path) -> str:
        """URL of one that holds nothing, not even a schema."""

    def copy(self, template: str, path: Path) -> str:
        """URL of a copy of one that nobody has open."""

    def drop(self, url: str) -> None:
        """Let go of it."""

    def take_away(self, url: str) -> None:
        """Make the database refuse connections."""


class SqliteDatabases:
    """Files."""

    def new(self, path: Path) -> str:
        return sqlite_url(path)

    def copy(self, template: str, path: Path) -> str:
        return sqlite_url(shutil.copy(make_url(template).database or "", path))

    def drop(self, url: str) -> None:
        """The test's folder goes as a whole."""

    def take_away(self, url: str) -> None:
        """A directory where the database was."""
        path = Path(make_url(url).database or "")
        for name in (f"{path.name}-wal", f"{path.name}-shm", path.name):
            (path.parent / name).unlink(missing_ok=True)
        path.mkdir()


class PostgresqlDatabases:
    """Databases of a server."""

    def __init__(self, server: PostgresServer) -> None:
        self._server = server

    def new(self, path: Path) -> str:
        return self._create(path, "template0")

    def copy(self, template: str, path: Path) -> str:
        return self._create(path, make_url(template).database or "")

    def drop(self, url: str) -> None:
        self._server.execute(f'DROP DATABASE "{make_url(url).database}" WITH (FORCE)')

    def take_away(self, url: str) -> None:
        """Make the database refuse connections."""
        name = make_url(url).database
        self._server.execute(f'ALTER DATABASE "{name}" ALLOW_CONNECTIONS false')
        self._server.execute(f"SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE datname = '{name}'")

    def _create(self, path: Path, template: str) -> str:
        name = f"{path.stem}_{next(NUMBERS)}"
        self._server.execute(f'CREATE DATABASE "{name}" TEMPLATE "{template}" {copying()}')
        return self._server.database(name)


def copying() -> str:
    """Return how the server copies a template: file by file, with less work than by its log, the default since version 15."""
    return "STRATEGY FILE_COPY" if version() >= FIRST_WITH_STRATEGIES else ""


@contextlib.contextmanager
def opened(databases: Databases, template: str, path: Path) -> Iterator[Database]:
    """A copy of a database, open for a while."""
    url = databases.copy(template, path)
    database = Database(url)
    try:
        yield database
    finally:
        database.close()
        databases.drop(url)
