"""Fixtures of the end-to-end tests."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.databases import Databases
from tests.end_to_end.processes import Service


@pytest.fixture
def service(tmp_path: Path, databases: Databases) -> Iterator[Service]:
    """A place for a service, with a database that does not exist yet or is empty; the test starts it."""
    place = Service(tmp_path, database=databases.new(tmp_path / "rundown.db"))
    yield place
    place.client.close()
    databases.drop(place.database)
