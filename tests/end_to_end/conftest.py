"""Fixtures of the end-to-end tests."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.end_to_end.processes import Service


@pytest.fixture
def service(tmp_path: Path) -> Iterator[Service]:
    """A place for a service; the test starts it."""
    place = Service(tmp_path)
    yield place
    place.client.close()
