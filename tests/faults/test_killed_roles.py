"""`kill -9` of any role at any moment, 20 times, under load; `python -m benchmarks.faults --only roles` kills 200 times."""

from pathlib import Path

import pytest

from tests.databases import PostgresqlDatabases
from tests.faults import roles
from tests.plant import sqlite_url
from tests.postgresql import PostgresServer

KILLS = 20


@pytest.mark.long
def test_roles_killed_on_postgresql(tmp_path: Path, postgresql: PostgresServer) -> None:
    databases = PostgresqlDatabases(postgresql)
    url = databases.new(tmp_path / "killed.db")
    try:
        killed = roles.killed_at_random(tmp_path, database=url, names=roles.ROLES, seed=1, kills=KILLS)
    finally:
        databases.drop(url)
    print(killed)
    assert sum(killed.kills.values()) == KILLS
    assert set(killed.kills) == set(roles.ROLES)


@pytest.mark.long
def test_one_process_killed_on_sqlite(tmp_path: Path) -> None:
    url = sqlite_url(tmp_path / "rundown.db")
    killed = roles.killed_at_random(tmp_path, database=url, names=roles.ALONE, seed=2, kills=KILLS)
    print(killed)
    assert killed.kills == {"all1": KILLS}


@pytest.mark.long
def test_one_process_killed_twice(tmp_path: Path) -> None:
    url = sqlite_url(tmp_path / "rundown.db")
    killed = roles.killed_at_random(tmp_path, database=url, names=roles.ALONE, seed=3, kills=2, identified=1)
    assert killed.kills == {"all1": 2}
