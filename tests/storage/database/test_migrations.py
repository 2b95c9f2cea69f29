"""Each migration, one by one, up and down, with rows in every table: whatever both schemas can hold stays as it is."""

from collections.abc import Set
from typing import Any

import alembic.command
import alembic.config
import pytest
from alembic.script import ScriptDirectory
from sqlalchemy import JSON, Boolean, Column, Connection, Float, Integer, LargeBinary, MetaData, String, Table, insert, select

from storage.database.engine import Database
from storage.database.schema import KEPT_BY_ITSELF, MIGRATIONS, known_revisions
from storage.tables.base import Base
from tests.storage.migration import migrate

ROWS = 2
TABLES = [table for table in Base.metadata.sorted_tables if table.name not in KEPT_BY_ITSELF]
Contents = dict[str, dict[str, list[Any]]]
"""Of each table and column the values, in the order of the rows."""
CHANGED = {("0004", "alerts", "state"): "an alert that is over is normal"}
"""Columns that an upgrade changes on purpose, and why."""


def script() -> ScriptDirectory:
    return ScriptDirectory(str(MIGRATIONS))


REVISIONS = [revision.revision for revision in script().walk_revisions()][::-1]


def test_the_names_of_the_files_tell_their_order() -> None:
    assert known_revisions() == REVISIONS[::-1]


def value(column: Column[Any], row: int) -> Any:
    """Something that fits; what refers to another table refers to the row of the same number there."""
    for key in column.foreign_keys:
        return value(key.column, row)
    kind = column.type
    if isinstance(kind, Boolean):
        return bool(row % 2)
    if isinstance(kind, Integer):
        return row
    if isinstance(kind, Float):
        return 0.1 * row
    if isinstance(kind, LargeBinary):
        return bytes([0, 255, row])
    if isinstance(kind, JSON):
        return {"ä": [row, None, 0.1]}
    assert isinstance(kind, String), column
    text = f"{column.name} Ω{row}"
    return text if kind.length is None else text[-kind.length :]


def fill(connection: Connection, tables: list[Table]) -> None:
    for table in tables:
        for row in range(1, ROWS + 1):
            connection.execute(insert(table).values({column.name: value(column, row) for column in table.columns}))


def reflected(connection: Connection) -> list[Table]:
    found = MetaData()
    found.reflect(connection)
    return [table for table in found.sorted_tables if table.name not in {"alembic_version"} | KEPT_BY_ITSELF]


def reflected_names(table: Table) -> list[str]:
    return [column.name for column in table.columns]


def contents(database: Database) -> Contents:
    found: Contents = {}
    with database.engine.connect() as connection:
        for table in reflected(connection):
            rows = connection.execute(select(table).order_by(*table.primary_key.columns)).all()
            found[table.name] = {name: [row._mapping[name] for row in rows] for name in reflected_names(table)}
    return found


def assert_kept(before: Contents, after: Contents, *, changed: Set[tuple[str, str]] = frozenset()) -> None:
    for table in before.keys() & after.keys():
        for name in before[table].keys() & after[table].keys():
            if (table, name) not in changed:
                assert after[table][name] == before[table][name], (table, name)


def test_downgrades_keep_what_the_older_schema_can_hold(database: Database) -> None:
    with database.engine.begin() as connection:
        fill(connection, TABLES)
    before = contents(database)
    assert before.keys() == {table.name for table in TABLES}
    assert all(len(rows) == ROWS for columns in before.values() for rows in columns.values())
    for revision in REVISIONS[-2::-1]:
        migrate(database, alembic.command.downgrade, revision)
        after = contents(database)
        assert after.keys() <= before.keys()
        assert_kept(before, after)
        before = after
    migrate(database, alembic.command.upgrade, "head")
    assert_kept(before, contents(database), changed={("alerts", "state")})


@pytest.mark.parametrize("first", [REVISIONS[0], REVISIONS[-2]])
def test_upgrades_keep_everything(database: Database, first: str) -> None:
    migrate(database, alembic.command.downgrade, first)
    with database.engine.begin() as connection:
        fill(connection, reflected(connection))
    before = contents(database)
    for revision in REVISIONS[REVISIONS.index(first) + 1 :]:
        migrate(database, alembic.command.upgrade, revision)
        after = contents(database)
        for table, columns in before.items():
            assert columns.keys() <= after[table].keys()
        assert_kept(before, after, changed={(table, name) for number, table, name in CHANGED if number == revision})
        before = after
    assert before.keys() == {table.name for table in TABLES}
