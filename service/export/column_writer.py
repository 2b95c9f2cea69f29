"""Writes tables piece by piece as CSV and Parquet, with the meaning of each column."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from formats.files.csv_cells import CsvWriter
from storage.clock import to_datetime
from storage.files.private_files import prepare

ColumnKind = Literal["integer", "number", "text", "truth", "time"]

TableRows = Sequence[Sequence[Any]]


class ParquetMissing(RuntimeError):
    """Parquet needs the extra rotorundown[parquet]."""


@dataclass(frozen=True)
class Column:
    """One column. time: nanoseconds since 1970; RFC 3339 in CSV, a timestamp [ns, UTC] in Parquet. unit: empty for none."""

    name: str
    kind: ColumnKind
    meaning: str
    unit: str = ""


def write(folder: Path, name: str, columns: Sequence[Column], pieces: Iterable[TableRows]) -> int:
    """Write `name`.csv (RFC 4180, missing values empty) and `name`.parquet at once, for their owner only.

    Returns the number of rows. Raises ParquetMissing, OSError.
    """
    try:
        from arro3.core import RecordBatchReader, Schema
        from arro3.io import write_parquet
    except ImportError as error:
        raise ParquetMissing("Parquet needs the extra rotorundown[parquet], which is not installed here") from error
    count = 0

    def batches(writer: CsvWriter) -> Iterator[Any]:
        nonlocal count
        for rows in pieces:
            if rows:
                count += len(rows)
                writer.rows([_cell_text(column, value) for column, value in zip(columns, row, strict=True)] for row in rows)
                yield _batch(columns, rows)

    prepare(folder / f"{name}.csv")
    prepare(folder / f"{name}.parquet")
    with (folder / f"{name}.csv").open("w", newline="") as file:
        writer = CsvWriter(file)
        writer.row(column.name for column in columns)
        schema = Schema([_field(column) for column in columns])
        reader = RecordBatchReader.from_batches(schema, batches(writer))
        write_parquet(reader, folder / f"{name}.parquet", compression="zstd(1)")
    return count


def _field(column: Column) -> Any:
    from arro3.core import DataType, Field

    types = {
        "integer": DataType.int64(),
        "number": DataType.float64(),
        "text": DataType.utf8(),
        "truth": DataType.bool(),
        "time": DataType.timestamp("ns", tz="UTC"),
    }
    return Field(column.name, types[column.kind], nullable=True)


def _batch(columns: Sequence[Column], rows: TableRows) -> Any:
    from arro3.core import Array, DataType, RecordBatch, Schema

    arrays = []
    for column, values in zip(columns, zip(*rows, strict=True), strict=True):
        held = [None if _missing(value) else value for value in values]
        if column.kind == "time":
            arrays.append(Array(held, type=DataType.int64()).cast(DataType.timestamp("ns", tz="UTC")))
        else:
            arrays.append(Array(held, type=_field(column).type))
    return RecordBatch.from_arrays(arrays, schema=Schema([_field(column) for column in columns]))


def _cell_text(column: Column, value: Any) -> Any:
    if _missing(value):
        return ""
    if column.kind == "time":
        return f"{to_datetime(value):%Y-%m-%dT%H:%M:%S}.{value % 1_000_000_000:09d}Z"
    return str(value).lower() if column.kind == "truth" else value


def _missing(value: Any) -> bool:
    return value is None or (isinstance(value, float) and not math.isfinite(value))
