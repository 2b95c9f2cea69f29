"""Fixtures that the tests of storage and service share. Databases are copies of ones made once: migrating takes its time."""

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from storage import machines
from storage.database import Database
from tests.plant import machine, sqlite_url


@pytest.fixture(scope="session")
def empty_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An SQLite file whose schema is up to date."""
    path = tmp_path_factory.mktemp("templates") / "empty.db"
    Database(sqlite_url(path)).close()
    return path


@pytest.fixture(scope="session")
def plant_file(empty_file: Path) -> Path:
    """The same with the machine of `tests.plant`."""
    path = Path(shutil.copy(empty_file, empty_file.with_name("plant.db")))
    opened = Database(sqlite_url(path))
    with opened.transaction() as session:
        machines.create(session, machine())
    opened.close()
    return path


def opened_copy(template: Path, path: Path) -> Iterator[Database]:
    """A copy of a database, open until the test is over."""
    opened = Database(sqlite_url(shutil.copy(template, path)))
    yield opened
    opened.close()


@pytest.fixture
def database(empty_file: Path, tmp_path: Path) -> Iterator[Database]:
    """An empty database in a file."""
    yield from opened_copy(empty_file, tmp_path / "rundown.db")


@pytest.fixture
def plant(plant_file: Path, tmp_path: Path) -> Iterator[Database]:
    """A database that knows the machine of `tests.plant`."""
    yield from opened_copy(plant_file, tmp_path / "rundown.db")
