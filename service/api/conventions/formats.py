"""Answers with one table as JSON, CSV or Parquet, chosen by `?format=` or the Accept header."""

import io
import math
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime, timedelta
from typing import Any, Literal

from fastapi import HTTPException, Request, status

from formats.files.csv_cells import CsvWriter

Format = Literal["json", "csv", "parquet"]

JSON = "application/json"
CSV = "text/csv"
PARQUET = "application/vnd.apache.parquet"
MEDIA_TYPES: Mapping[Format, str] = {"json": JSON, "csv": CSV, "parquet": PARQUET}

EPOCH = datetime(1970, 1, 1, tzinfo=UTC)

ColumnContents = Sequence[Any]


def negotiated_format(request: Request, chosen: Format | None) -> Format:
    """Return the requested format, by default JSON. Raises HTTPException 406 when the client accepts none of them.

    Source: RFC 9110 §12.5.1, without parameters other than q.
    """
    if chosen is not None:
        return chosen
    wanted = _weights(request.headers.get("accept", "*/*"))
    found = {name: _weight(wanted, media) for name, media in MEDIA_TYPES.items()}
    best = max(found, key=lambda name: found[name])  # on equal weights JSON wins, as the first
    if found[best] <= 0.0:
        offered = ", ".join(MEDIA_TYPES.values())
        raise HTTPException(status.HTTP_406_NOT_ACCEPTABLE, f"available as {offered}; choose by Accept or ?format=")
    return best


def csv_bytes(columns: Mapping[str, ColumnContents]) -> bytes:
    """Return a header line and the rows as CSV (RFC 4180); missing values are empty."""
    text = io.StringIO()
    writer = CsvWriter(text)
    writer.row(columns)
    writer.rows(zip(*([_cell_value(value) for value in column] for column in columns.values()), strict=True))
    return text.getvalue().encode()


def parquet_bytes(columns: Mapping[str, ColumnContents], *, times: Sequence[str]) -> bytes:
    """Return an Apache Parquet file; the columns named in `times` hold RFC 3339 texts and become timestamps [µs, UTC].

    Raises HTTPException 406 where the extra `rotorundown[parquet]` is not installed.
    """
    try:
        from arro3.core import Array, DataType, Table
        from arro3.io import write_parquet
    except ImportError:
        raise HTTPException(
            status.HTTP_406_NOT_ACCEPTABLE, "Parquet needs the extra rotorundown[parquet], which is not installed here"
        ) from None
    types = {float: DataType.float64(), int: DataType.int64(), bool: DataType.bool(), str: DataType.utf8()}
    arrays: dict[str, Any] = {}
    for name, column in columns.items():
        if name in times:
            moments = [(datetime.fromisoformat(value) - EPOCH) // timedelta(microseconds=1) for value in column]
            arrays[name] = Array(moments, type=DataType.int64()).cast(DataType.timestamp("us", tz="UTC"))
        else:
            kind = next((type(value) for value in column if value is not None), float)
            arrays[name] = Array([None if _missing(value) else value for value in column], type=types[kind])
    file = io.BytesIO()
    write_parquet(Table.from_pydict(arrays), file, compression="zstd(1)")
    return file.getvalue()


def _missing(value: Any) -> bool:
    return value is None or (isinstance(value, float) and not math.isfinite(value))


def _cell_value(value: Any) -> Any:
    return "" if _missing(value) else value


def _weights(accept: str) -> dict[str, float]:
    found = {}
    for part in accept.split(","):
        media, *parameters = (piece.strip().lower() for piece in part.split(";"))
        weight = 1.0
        for parameter in parameters:
            name, _, value = parameter.partition("=")
            if name.strip() == "q":
                weight = float(value) if value.replace(".", "", 1).isdigit() else 0.0
        if media:
            found[media] = weight
    return found or {"*/*": 1.0}


def _weight(wanted: Mapping[str, float], media: str) -> float:
    kind = media.split("/")[0]
    return next((wanted[one] for one in (media, f"{kind}/*", "*/*") if one in wanted), 0.0)
