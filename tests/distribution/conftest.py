"""Fixtures of the tests of several processes on one database."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.databases import PostgresqlDatabases
from tests.distribution.layout import Layout
from tests.postgresql import PostgresServer


@pytest.fixture
def layout(tmp_path: Path, postgresql: PostgresServer) -> Iterator[Layout]:
    """A router and an empty database without any table; the test starts the processes."""
    databases = PostgresqlDatabases(postgresql)
    url = databases.new(tmp_path / "shared.db")
    try:
        with Layout(tmp_path, database=url) as one:
            yield one
    finally:
        databases.drop(url)
