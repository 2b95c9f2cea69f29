"""Taking all data over from one database to another, of whatever kind: all of them, compared in the end, or none.

Older releases let NUL into texts, which SQLite keeps and PostgreSQL cannot: there it is escaped (`storage.encoding.text`).
"""

import math
from collections import Counter
from contextlib import closing
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path
from typing import Any

from sqlalchemy import JSON, URL, Column, Connection, MetaData, Result, Table, func, insert, select, text

from storage.database.claim import file_of
from storage.database.engine import Database, redacted_url, require_file, temporary_engine
from storage.database.schema import KEPT_BY_ITSELF, require_known, revision_of, row_counts
from storage.encoding.text import finite, nul_escaped
from storage.tables import Base

AT_ONCE = 200
"""Rows on their way at a time."""


class TransferFailed(RuntimeError):
    """The data were not taken over and the target is as it was; the message says why."""


@dataclass(frozen=True)
class TransferReport:
    """What was taken over. rows: of each table; escaped: texts in which NUL was escaped, of each `table.column` with any."""

    rows: dict[str, int]
    escaped: dict[str, int]


def move(source_url: str, target_url: str) -> TransferReport:
    """Take over everything into a database that holds no data.

    The source is brought up to date first, and else left as it is. Raises TransferFailed, DatabaseUnusable; also where there
    is no source, and while a service uses one of them.
    """
    _require_source(source_url)
    with closing(Database(source_url)) as source, closing(Database(target_url)) as target:
        if _place(source) == _place(target):
            raise TransferFailed("source and target are the same database")
        source.claim()
        target.claim()
        with source.engine.connect() as reading, target.for_writing.begin() as writing:
            for one in (reading, writing):
                if one.dialect.name == "postgresql":  # each waits for the other
                    one.execute(text("SET LOCAL idle_in_transaction_session_timeout = 0"))
            held = sum(row_counts(writing).values())
            if held:
                raise TransferFailed(f"database {redacted_url(target_url)} holds {held} rows: it must be a new one")
            tables = _tables()
            escaped: Counter[str] = Counter()
            for table in tables:
                escaped += _copy(table, reading, writing)
            found = {table.name: _compared(table, reading, writing) for table in tables}
            for table in tables:
                _advance_sequences(table, reading, writing)
        return TransferReport(found, dict(escaped))


def _require_source(url: str) -> None:
    """Raises DatabaseUnusable: a database that is opened to be written to is made where there is none."""
    require_file(url)
    with temporary_engine(url) as engine, engine.connect() as connection:
        require_known(revision_of(connection), f"database {redacted_url(url)}")


def _place(database: Database) -> Path | URL:
    """Where its data are; an SQLite file may go by several names."""
    return file_of(database.engine) or database.engine.url


def _tables() -> list[Table]:
    """The tables in an order in which what is referred to comes first, their JSON so that its null is not the database's."""
    copied = MetaData()
    for table in Base.metadata.sorted_tables:
        for column in table.to_metadata(copied).columns:
            if isinstance(column.type, JSON):
                column.type = JSON(none_as_null=True)
    return [copied.tables[table.name] for table in Base.metadata.sorted_tables if table.name not in KEPT_BY_ITSELF]


def _rows(table: Table, connection: Connection) -> Result[Any]:
    """All rows in the order of their keys; behind the columns, whether each is NULL."""
    empty = [column.is_(None) for column in table.columns]
    query = select(*table.columns, *(one.label(f"empty_{i}") for i, one in enumerate(empty)))
    return connection.execute(query.order_by(*table.primary_key.columns), execution_options={"yield_per": AT_ONCE})


def _values(table: Table, row: Any) -> tuple[Any, ...]:
    """What to insert for a row."""
    found: list[Any] = []
    for value, empty, column in zip(row, row[len(table.columns) :], table.columns, strict=False):
        if empty:
            found.append(None)
        elif isinstance(column.type, JSON):
            found.append(JSON.NULL if value is None else finite(value))
        else:
            found.append(value)
    return tuple(found)


def _copy(table: Table, reading: Connection, writing: Connection) -> Counter[str]:
    """Returns in how many texts NUL was escaped."""
    names = [column.name for column in table.columns]
    escaped: Counter[str] = Counter()
    with _rows(table, reading) as rows:
        for part in rows.partitions():
            taken = [_values(table, row) for row in part]
            stored = [_storable(table, row, writing) for row in taken]
            for i, name in enumerate(names):
                changed = sum(isinstance(old[i], str) and old[i] != new[i] for old, new in zip(taken, stored, strict=True))
                escaped += Counter({f"{table.name}.{name}": changed})
            writing.execute(insert(table), [dict(zip(names, row, strict=True)) for row in stored])
    return escaped


def _storable(table: Table, values: tuple[Any, ...], writing: Connection) -> tuple[Any, ...]:
    """Values as the target can hold them. Raises TransferFailed where a text is too long then."""
    if writing.dialect.name != "postgresql":
        return values
    return tuple(
        _escaped(table, column, one, values) if isinstance(one, str) and "\0" in one else one
        for column, one in zip(table.columns, values, strict=True)
    )


def _escaped(table: Table, column: Column[Any], text: str, values: tuple[Any, ...]) -> str:
    if isinstance(column.type, JSON):  # its text has escapes of its own
        return text
    found = nul_escaped(text)
    longest = getattr(column.type, "length", None)
    if longest is not None and len(found) > longest:
        keys = ", ".join(str(one) for key, one in zip(table.columns, values, strict=True) if key.primary_key)
        raise TransferFailed(
            f"{table.name} ({keys}): {column.name} holds NUL, which PostgreSQL cannot, and with it escaped would have "
            f"{len(found)} characters, of which {longest} are allowed: shorten it in the source"
        )
    return found


def _compared(table: Table, reading: Connection, writing: Connection) -> int:
    """How many rows there are; raises TransferFailed where one is not the same on both sides."""
    count = 0
    with _rows(table, reading) as before, _rows(table, writing) as after:
        for old, new in zip_longest(before, after):
            if old is None or new is None or _comparable(table, old, writing) != _comparable(table, new, writing):
                keys = ", ".join(str((old or new)._mapping[column.name]) for column in table.primary_key.columns)
                raise TransferFailed(f"{table.name} ({keys}) was not taken over as it was")
            count += 1
    return count


def _comparable(table: Table, row: Any, writing: Connection) -> list[Any]:
    """Values of which each equals itself: SQLite has no NaN, there is NULL in its place, and PostgreSQL has no NUL."""
    values = _storable(table, _values(table, row), writing)
    return [None if isinstance(value, float) and math.isnan(value) else value for value in values]


def _advance_sequences(table: Table, reading: Connection, writing: Connection) -> None:
    """The next row gets the number behind the highest one that was ever given, also to a row that is no longer there."""
    highest = max(_highest(table, reading), _highest(table, writing))
    if not highest:
        return
    if (sequence := _sequence(table, writing)) is not None:
        writing.execute(text("SELECT setval(:sequence, :highest)"), {"sequence": sequence, "highest": highest})
    elif _counted_by_sqlite(table, writing):
        writing.execute(text("DELETE FROM sqlite_sequence WHERE name = :name"), {"name": table.name})
        writing.execute(text("INSERT INTO sqlite_sequence VALUES (:name, :highest)"), {"name": table.name, "highest": highest})


def _highest(table: Table, connection: Connection) -> int:
    """The highest number that a table's rows have or, as far as the database remembers, ever had; 0 where it gives none."""
    column = table.autoincrement_column
    if column is None:
        return 0
    given: int | None = None
    if (sequence := _sequence(table, connection)) is not None:
        given = connection.scalar(text("SELECT pg_sequence_last_value(CAST(:sequence AS regclass))"), {"sequence": sequence})
    elif _counted_by_sqlite(table, connection):
        given = connection.scalar(text("SELECT seq FROM sqlite_sequence WHERE name = :name"), {"name": table.name})
    return max(0, given or 0, connection.scalar(select(func.max(column))) or 0)


def _counted_by_sqlite(table: Table, connection: Connection) -> bool:
    """Whether this is SQLite, and it remembers the highest number that it gave to a row of the table."""
    return connection.dialect.name == "sqlite" and bool(table.dialect_options["sqlite"]["autoincrement"])


def _sequence(table: Table, connection: Connection) -> str | None:
    """Name of what gives the numbers on PostgreSQL; None where nothing does."""
    column = table.autoincrement_column
    if column is None or connection.dialect.name != "postgresql":
        return None
    query = text("SELECT pg_get_serial_sequence(:table, :column)")
    found = connection.scalar(query, {"table": f'"{table.name}"', "column": column.name})
    return None if found is None else str(found)
