"""Fixtures of the tests of jobs: a worker process, and the API that asks for them."""

from collections.abc import Iterator

import pytest

from service.api.cache.model_process import ModelProcess
from service.workers.executors import LocalExecutor
from storage.database.engine import Database
from tests.api_in_process import Api
from tests.identification import working


@pytest.fixture(scope="module")
def executor() -> Iterator[LocalExecutor]:
    """A worker process for the tests of a module that leave it alive: to start one and import all it needs takes seconds."""
    with working(1) as one:
        yield one


@pytest.fixture
def api(database: Database, process: ModelProcess) -> Api:
    """The API in this process."""
    found = Api(database)
    found.app.state.model_process = process
    return found
