"""Fixtures that the tests of storage and service share: databases of the kind that is asked for, see `tests.databases`."""

import contextlib
import functools
import gc
import itertools
import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from sqlalchemy import event, inspect

from storage.database.engine import Database
from storage.machines import machines
from storage.tables.alerting import AlertRow
from tests.databases import KIND_ASKED_FOR, Databases, Kind, NewDatabase, PostgresqlDatabases, SqliteDatabases, chosen, opened
from tests.plant import machine
from tests.postgresql import FAST, PostgresServer, server

TESTS = Path(__file__).parent
FIRST = (
    "browser/test_alert_page.py",
    "browser/test_login.py",
    "browser/test_balancing_print.py",
    "faults/test_killed_roles.py",
    "faults/test_deleted_logs.py",
    "faults/test_endurance.py",
    "distribution",
    "end_to_end",
    "faults",
    "browser",
    "service/identification",
    "storage/backup",
    "service/api/test_contract.py",
    "benchmarks/test_fleet.py",
    "film_plant_tests",
    "estimator/fit/validation",
    "estimator/identification",
    "estimator/diagnosis",
    "test_house_figures.py",
    "test_places_to_touch.py",
)
"""Folders and files that take as long as hundreds of other tests: last, they would leave one process alone with them.

One file of the browser's makes the store that most of them look at; meanwhile come those that have a store of their own.
"""
GARBAGE = (50_000, 20, 50)
"""After how many new objects their garbage is looked for, and how rarely among older ones."""


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Begin with what takes longest; on a kind of database that was asked for only what uses one is run."""
    if KIND_ASKED_FOR in os.environ:
        others = [item for item in items if not uses_database(item)]
        config.hook.pytest_deselected(items=others)
        items[:] = [item for item in items if uses_database(item)]
    items.sort(key=lambda item: turn(item.path))


def uses_database(item: pytest.Item) -> bool:
    """Return whether a test asks for a database of the kind that was asked for, itself or by its fixtures.

    Without `stores` a `kind` is a parameter of the test's own; without `kind` a store is of the kind that the test names.
    """
    return {"stores", "kind"} <= set(getattr(item, "fixturenames", ()))


@functools.cache
def turn(path: Path) -> int:
    """Return the place in `FIRST` of a file of tests or of a folder that it lies in, at any depth; its length for all else."""
    inside = (path, *path.parents)
    return next((place for place, name in enumerate(FIRST) if TESTS / name in inside), len(FIRST))


@event.listens_for(AlertRow, "before_update")
def require_time_of_change(_mapper: object, _connection: object, row: AlertRow) -> None:
    """Hold that an alert's evidence changes only together with its time of change: caches rest on it."""
    changed = inspect(row).attrs
    assert changed.updated_at.history.has_changes() or not changed.evidence.history.has_changes(), "evidence without its time"


def pytest_sessionstart(session: pytest.Session) -> None:
    """Look for no garbage while tests are imported: what they import stays. The process that only hands out tests has none."""
    if not session.config.getoption("numprocesses", None):
        gc.disable()


def pytest_collection_finish() -> None:
    """Keep what has been imported out of garbage collection: to look through it for garbage again and again takes a twentieth
    of the time, and to look after every 700 new objects as much again."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(*GARBAGE)
    gc.enable()


@pytest.fixture(scope="session")
def postgresql() -> Iterator[PostgresServer]:
    """A PostgreSQL server for this process of tests."""
    with server(*FAST) as one:
        yield one


class Stores:
    """Databases of each kind and their templates, made once when they are first asked for."""

    def __init__(self, request: pytest.FixtureRequest, folders: pytest.TempPathFactory) -> None:
        self._request = request
        self._folders = folders

    @functools.cache  # noqa: B019 - one for each process of tests
    def databases(self, kind: Kind) -> Databases:
        """Return where databases come from."""
        if kind == "sqlite":
            return SqliteDatabases()
        return PostgresqlDatabases(self._request.getfixturevalue("postgresql"))

    @functools.cache  # noqa: B019
    def empty(self, kind: Kind) -> str:
        """URL of a database whose schema is up to date."""
        url = self.databases(kind).new(self._folders.mktemp("templates") / "empty.db")
        Database(url).close()
        return url

    @functools.cache  # noqa: B019
    def plant(self, kind: Kind) -> str:
        """The same with the machine of `tests.plant`."""
        url = self.databases(kind).copy(self.empty(kind), self._folders.mktemp("templates") / "plant.db")
        database = Database(url)
        with database.transaction() as session:
            machines.create(session, machine())
        database.close()
        return url


@pytest.fixture(scope="session")
def stores(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Stores:
    """By kind: what tests/storage makes of either kind must not serve others too."""
    return Stores(request, tmp_path_factory)


@pytest.fixture(scope="session")
def kind() -> Kind:
    """Return which kind of database is tested."""
    return chosen()


@pytest.fixture(scope="session")
def databases(kind: Kind, stores: Stores) -> Databases:
    """Return where databases come from."""
    return stores.databases(kind)


@pytest.fixture(scope="session")
def empty_template(kind: Kind, stores: Stores) -> str:
    """URL of a database whose schema is up to date."""
    return stores.empty(kind)


@pytest.fixture(scope="session")
def plant_template(kind: Kind, stores: Stores) -> str:
    """The same with the machine of `tests.plant`."""
    return stores.plant(kind)


@pytest.fixture
def database(databases: Databases, empty_template: str, tmp_path: Path) -> Iterator[Database]:
    """An empty database, in the file rundown.db if it is one."""
    with opened(databases, empty_template, tmp_path / "rundown.db") as one:
        yield one


@pytest.fixture
def plant(databases: Databases, plant_template: str, tmp_path: Path) -> Iterator[Database]:
    """A database that knows the machine of `tests.plant`, in the file rundown.db if it is one."""
    with opened(databases, plant_template, tmp_path / "rundown.db") as one:
        yield one


@pytest.fixture
def new_database(databases: Databases, tmp_path: Path) -> Iterator[NewDatabase]:
    """Makes databases besides."""
    numbers = itertools.count(1)
    with contextlib.ExitStack() as open_ones:
        yield lambda template: open_ones.enter_context(opened(databases, template, tmp_path / f"other{next(numbers)}.db"))
