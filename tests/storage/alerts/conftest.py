"""An identification that alerts are of."""

import pytest

from storage.database.engine import Database
from tests.plant import START, identification, store_identification


@pytest.fixture
def found(plant: Database) -> int:
    """Return the id of a stored identification."""
    with plant.transaction() as session:
        return store_identification(session, identification(), run_id=1, measured_at=START).id
