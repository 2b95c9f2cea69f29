"""Fixtures of the service's tests."""

from collections.abc import Iterator

import pytest
import zenoh

from service.messaging.session import connected, session
from service.runs.collector import Collector
from storage.database.engine import Database
from tests.plant import free_endpoint, wait_until
from tests.prompt_journal import PromptJournal


@pytest.fixture
def journal(plant: Database) -> PromptJournal:
    """A journal as a service that just started has it."""
    return PromptJournal(plant, Collector())


@pytest.fixture(scope="module")
def endpoint() -> str:
    """Where the module's zenoh router listens: opening one takes half a second."""
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
