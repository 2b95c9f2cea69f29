"""Transferring all data from one database to another of either kind: all rows, compared at the end, or none.

Older releases allowed NUL in text. SQLite stores it and PostgreSQL cannot: there it is escaped (`storage.encoding.text`).
"""

import math
from collections import Counter
from collections.abc import Callable
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
from storage.tables.base import Base

AT_ONCE = 200
"""Rows transferred per batch."""


class TransferFailed(RuntimeError):
    """The data were not transferred and the target is unchanged; the message states the cause."""


@dataclass(frozen=True)
class TransferReport:
    """Counts of a transfer. rows: rows per table; escaped: texts with escaped NUL per `table.column`, where there are any."""

    rows: dict[str, int]
    escaped: dict[str, int]


def move(source_url: str, target_url: str, report: Callable[[int, int], None] = lambda _done, _all: None) -> TransferReport:
    """Transfer all data into an empty database. report: receives the numbers of rows done and to do.

    The source's schema is upgraded first; nothing else in it changes. Raises TransferFailed, DatabaseUnusable; also when the
    source does not exist, and while a service uses one of the two.
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
            progress = _RowProgress(report, 2 * sum(row_counts(reading).values()))
            for table in tables:
                escaped += _copy(table, reading, writing, progress)
            found = {table.name: _compared(table, reading, writing, progress) for table in tables}
            for table in tables:
                _advance_sequences(table, reading, writing)
        return TransferReport(found, dict(escaped))


def _require_source(url: str) -> None:
    """Raise DatabaseUnusable unless the source exists; opening it for writing would create it."""
    require_file(url)
    with temporary_engine(url) as engine, engine.connect() as connection:
        require_known(revision_of(connection), f"database {redacted_url(url)}")


def _place(database: Database) -> Path | URL:
    """Return the file or URL that identifies a database; an SQLite file may have several names."""
    return file_of(database.engine) or database.engine.url


def _tables() -> list[Table]:
    """Return copies of the tables, referenced tables first; JSON null in their columns stays distinct from SQL NULL."""
    copied = MetaData()
    for table in Base.metadata.sorted_tables:
        for column in table.to_metadata(copied).columns:
            if isinstance(column.type, JSON):
                column.type = JSON(none_as_null=True)
    return [copied.tables[table.name] for table in Base.metadata.sorted_tables if table.name not in KEPT_BY_ITSELF]


def _rows(table: Table, connection: Connection) -> Result[Any]:
    """Return all rows by primary key; behind the columns follows, for each column, whether it is NULL."""
    empty = [column.is_(None) for column in table.columns]
    query = select(*table.columns, *(one.label(f"empty_{i}") for i, one in enumerate(empty)))
    return connection.execute(query.order_by(*table.primary_key.columns), execution_options={"yield_per": AT_ONCE})


def _values(table: Table, row: Any) -> tuple[Any, ...]:
    """Return the values to insert for a row."""
    found: list[Any] = []
    for value, empty, column in zip(row, row[len(table.columns) :], table.columns, strict=False):
        if empty:
            found.append(None)
        elif isinstance(column.type, JSON):
            found.append(JSON.NULL if value is None else finite(value))
        else:
            found.append(value)
    return tuple(found)


class _RowProgress:
    """Count of the rows that are done, reported as it grows."""

    def __init__(self, report: Callable[[int, int], None], total: int) -> None:
        self._report, self._total, self._done = report, total, 0

    def more(self, rows: int) -> None:
        """Report that some more rows are done."""
        self._done += rows
        self._report(self._done, self._total)


def _copy(table: Table, reading: Connection, writing: Connection, progress: _RowProgress) -> Counter[str]:
    """Copy a table's rows; return the number of texts per column in which NUL was escaped."""
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
            progress.more(len(stored))
    return escaped


def _storable(table: Table, values: tuple[Any, ...], writing: Connection) -> tuple[Any, ...]:
    """Return a row's values as the target can store them. Raises TransferFailed when an escaped text becomes too long."""
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


def _compared(table: Table, reading: Connection, writing: Connection, progress: _RowProgress) -> int:
    """Return the number of rows of a table; raise TransferFailed when a row differs between the two sides."""
    count = 0
    with _rows(table, reading) as before, _rows(table, writing) as after:
        for old, new in zip_longest(before, after):
            if old is None or new is None or _comparable(table, old, writing) != _comparable(table, new, writing):
                keys = ", ".join(str((old or new)._mapping[column.name]) for column in table.primary_key.columns)
                raise TransferFailed(f"{table.name} ({keys}) was not taken over as it was")
            count += 1
            if count % AT_ONCE == 0:
                progress.more(AT_ONCE)
    progress.more(count % AT_ONCE)
    return count


def _comparable(table: Table, row: Any, writing: Connection) -> list[Any]:
    """Return a row's values in comparable form: NaN as NULL, as SQLite stores it, and NUL as the target stores it."""
    values = _storable(table, _values(table, row), writing)
    return [None if isinstance(value, float) and math.isnan(value) else value for value in values]


def _advance_sequences(table: Table, reading: Connection, writing: Connection) -> None:
    """Set the target's sequence to continue behind the highest number ever given, deleted rows included."""
    highest = max(_highest(table, reading), _highest(table, writing))
    if not highest:
        return
    if (sequence := _sequence(table, writing)) is not None:
        writing.execute(text("SELECT setval(:sequence, :highest)"), {"sequence": sequence, "highest": highest})
    elif _counted_by_sqlite(table, writing):
        writing.execute(text("DELETE FROM sqlite_sequence WHERE name = :name"), {"name": table.name})
        writing.execute(text("INSERT INTO sqlite_sequence VALUES (:name, :highest)"), {"name": table.name, "highest": highest})


def _highest(table: Table, connection: Connection) -> int:
    """Return the highest number a table's rows have or, as far as the database remembers, had; 0 without an autoincrement
    column."""
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
    """Return whether SQLite remembers the highest number that it gave to a row of the table."""
    return connection.dialect.name == "sqlite" and bool(table.dialect_options["sqlite"]["autoincrement"])


def _sequence(table: Table, connection: Connection) -> str | None:
    """Return the name of the PostgreSQL sequence that numbers a table's rows; None without one."""
    column = table.autoincrement_column
    if column is None or connection.dialect.name != "postgresql":
        return None
    query = text("SELECT pg_get_serial_sequence(:table, :column)")
    found = connection.scalar(query, {"table": f'"{table.name}"', "column": column.name})
    return None if found is None else str(found)
