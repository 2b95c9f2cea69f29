"""What the tests of ingest share."""

from collections.abc import Iterator

import pytest
import zenoh

from service.ingest import periodic_checks
from service.ingest.ingest_thread import Ingest
from service.recovery import gap_recovery as healing_module
from service.sources.publisher import Source
from storage.database.engine import Database
from tests.plant import KEY
from tests.service.ingest.plant_network import DroppedOnTheWay, Edge, ingesting


@pytest.fixture(autouse=True)
def _impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    """Look at quiet sources often, and wait for a log less long, so that no test waits long."""
    monkeypatch.setattr(periodic_checks, "TAIL_CHECK_S", 0.1)
    monkeypatch.setattr(healing_module, "PATIENCE_S", 1.0)


@pytest.fixture
def ingest(router: zenoh.Session, plant: Database) -> Iterator[Ingest]:
    """A service that runs before any source does."""
    with ingesting(router, plant) as running:
        yield running


@pytest.fixture
def edge(client: zenoh.Session) -> Iterator[Edge]:
    with Source(client, KEY, name="edge") as source:
        yield Edge(source)


@pytest.fixture
def lossy(client: zenoh.Session) -> Iterator[DroppedOnTheWay]:
    source = DroppedOnTheWay(client)
    yield source
    source.leave()
