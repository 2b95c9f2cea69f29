"""An OPC UA server over the store with two plants."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from storage.database.engine import Database
from tests.databases import Databases, opened
from tests.service.opcua.second_stack import SecondStack, end_idle, second_stack
from tests.service.opcua.served_plants import ServedPlants, served_plants
from tests.service.security.two_plants import fill


@pytest.fixture(scope="session", autouse=True)
def end_second_stacks() -> Iterator[None]:
    """End the processes of the second stack with the session."""
    yield
    end_idle()


@pytest.fixture(scope="module")
def store(databases: Databases, empty_template: str, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Database]:
    """The store with two plants."""
    with opened(databases, empty_template, tmp_path_factory.mktemp("opcua") / "rundown.db") as database:
        yield database


@pytest.fixture(scope="module")
def served(store: Database, tmp_path_factory: pytest.TempPathFactory) -> Iterator[ServedPlants]:
    """A server with certificates, to which keys give access."""
    harbour, orchard = fill(store)
    with served_plants(store, tmp_path_factory.mktemp("pki"), harbour, orchard) as one:
        yield one


@pytest.fixture(scope="module")
def operator(served: ServedPlants, tmp_path_factory: pytest.TempPathFactory) -> Iterator[SecondStack]:
    """A client of another stack, of somebody who may acknowledge in the first plant, over Basic256Sha256."""
    with second_stack(served.endpoint, tmp_path_factory.mktemp("client"), **served.client("operator")) as client:
        yield client


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return where a client keeps its certificates."""
    return tmp_path
