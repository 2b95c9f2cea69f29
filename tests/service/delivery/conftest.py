"""Fixtures that the tests of delivery share."""

from collections.abc import Iterator

import pytest
import zenoh

from service.messaging.session import open_session
from storage.database.engine import Database
from storage.tables.findings import IdentificationRow
from tests.plant import START, identification, store_identification
from tests.ports import free_endpoint
from tests.service.delivery.receivers import Receiver, receiver


@pytest.fixture
def found(plant: Database) -> IdentificationRow:
    with plant.transaction() as session:
        return store_identification(session, identification(), run_id=1, measured_at=START)


@pytest.fixture
def http() -> Iterator[Receiver]:
    with receiver() as one:
        yield one


@pytest.fixture(scope="package")
def network() -> Iterator[tuple[zenoh.Session, str]]:
    """A router's session and its endpoint."""
    endpoint = free_endpoint()
    session = open_session(listen=[endpoint], connect=[])
    yield session, endpoint
    session.close()
