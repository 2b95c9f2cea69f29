"""Versions of databases, and what is known against them."""

import sqlite3

import pytest

from storage.database.engine import Database
from storage.database.versions import has_wal_reset_bug, postgresql_objections, sqlite_objections


@pytest.mark.parametrize(
    "version", [(3, 7, 0), (3, 40, 1), (3, 44, 5), (3, 45, 0), (3, 46, 1), (3, 50, 6), (3, 51, 0), (3, 51, 2)]
)
def test_the_wal_reset_bug_is_said_of_versions_that_have_it(version: tuple[int, ...]) -> None:
    (said,) = sqlite_objections(version)
    assert ".".join(map(str, version)) in said
    assert "3.51.3" in said


@pytest.mark.parametrize("version", [(3, 6, 23), (3, 44, 6), (3, 50, 7), (3, 51, 3), (3, 53, 0), (4, 0, 0)])
def test_nothing_is_said_of_versions_without_it(version: tuple[int, ...]) -> None:
    assert sqlite_objections(version) == []


def test_an_old_postgresql_is_said() -> None:
    assert "14.11 is older than 15" in postgresql_objections((14, 11))[0]
    assert postgresql_objections((15, 0)) == postgresql_objections((17, 2)) == []


def test_a_database_tells_its_version(database: Database) -> None:
    product, number = database.version.split(" ")
    if database.kind == "sqlite":
        assert (product, number) == ("SQLite", sqlite3.sqlite_version)
        assert bool(database.objections) == has_wal_reset_bug(sqlite3.sqlite_version_info)
    else:
        assert product == "PostgreSQL"
        assert int(number.split(".")[0]) >= 15
        assert database.objections == []
