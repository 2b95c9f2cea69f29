"""Fixtures of the service's tests."""

from collections.abc import Iterator

import pytest
import zenoh

from service.api.cache.model_process import ModelProcess
from service.ingest import periodic_checks
from service.ingest.ingest_thread import Ingest
from service.messaging.session import connected, session
from service.recovery import gap_recovery
from service.runs.collector import Collector
from service.sources.publisher import Source
from service.workers import process_setup
from storage.database.engine import Database
from tests.plant import KEY, wait_until
from tests.ports import free_endpoint
from tests.prompt_writer import PromptWriter
from tests.service.ingest.plant_network import DroppedOnTheWay, PublishingEdge, ingesting


@pytest.fixture(scope="session", autouse=True)
def urgent() -> Iterator[None]:
    """Worker processes are as urgent as the tests that wait for them: else they would starve beside other tests."""
    with pytest.MonkeyPatch.context() as changed:
        changed.setattr(process_setup, "NICENESS", 0)
        yield


@pytest.fixture(scope="module")
def process() -> Iterator[ModelProcess]:
    """A process that computes for all tests of a module: it takes a second or two to start."""
    one = ModelProcess()
    yield one
    one.close()


@pytest.fixture
def writer(plant: Database) -> PromptWriter:
    """A sample writer as a service that just started has it."""
    return PromptWriter(plant, Collector())


@pytest.fixture(scope="module")
def endpoint() -> str:
    """Return where the module's zenoh router listens: opening one takes half a second."""
    return free_endpoint()


@pytest.fixture(scope="module")
def router(endpoint: str) -> Iterator[zenoh.Session]:
    """The service's side of the network."""
    with session(listen=[endpoint], connect=[]) as opened:
        yield opened


@pytest.fixture(scope="module")
def client(router: zenoh.Session, endpoint: str) -> Iterator[zenoh.Session]:
    """A source's side of the network, connected."""
    with session(listen=[], connect=[endpoint]) as opened:
        wait_until(lambda: connected(opened) and connected(router))
        yield opened


@pytest.fixture
def short_waits(monkeypatch: pytest.MonkeyPatch) -> None:
    """Look at quiet sources often, and wait for a log less long, so that no test waits long."""
    monkeypatch.setattr(periodic_checks, "TAIL_CHECK_S", 0.1)
    monkeypatch.setattr(gap_recovery, "PATIENCE_S", 1.0)


@pytest.fixture
def ingest(router: zenoh.Session, plant: Database) -> Iterator[Ingest]:
    """A service that runs before any source does."""
    with ingesting(router, plant) as running:
        yield running


@pytest.fixture
def edge(client: zenoh.Session) -> Iterator[PublishingEdge]:
    """A source with a log."""
    with Source(client, KEY, name="edge") as source:
        yield PublishingEdge(source)


@pytest.fixture
def lossy(client: zenoh.Session) -> Iterator[DroppedOnTheWay]:
    """A source with a log, of whose messages the network drops some."""
    source = DroppedOnTheWay(client)
    yield source
    source.leave()
