"""Trends as InfluxDB line protocol, for Telegraf to fetch: what is fetched again is the same point there."""

import math
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, Literal

from sqlalchemy import Row

from service.api.trends.columns import ACCEPTED, NOT_ACCEPTED, NOT_ESTIMABLE, Columns
from service.api.trends.downsampling import Chosen
from service.export.line_protocol import line
from storage.tables.findings import IdentificationRow

TrendFormat = Literal["json", "csv", "parquet", "influx"]
LINES = "text/plain; charset=utf-8"
"""Media type of line protocol, which has none of its own."""
MEASUREMENT = "rundown_trend"


def trend_lines(machine_id: str, scope: str, found: Mapping[str, Columns], points: Mapping[str, Chosen]) -> bytes:
    """Return the chosen points of several parameters."""
    return _text(_points(machine_id, scope, found, points))


def filed_lines(rows: Mapping[int, IdentificationRow], values: Iterable[Row[Any]]) -> bytes:
    """Return the values of identifications, by their id."""
    return _text(
        line(
            MEASUREMENT,
            _tags(row.machine_id, one.parameter, one.unit, row.run_kind, quality_of(row.accepted, one.value), row.scope),
            {
                "value": magnitude(one.value, one.imaginary),
                "standard_error": one.standard_error if one.imaginary is None else None,
                "lower": one.lower,
                "upper": one.upper,
                "identification": row.id,
            },
            row.measured_at,
        )
        for one, row in ((one, rows[one.identification]) for one in values)
    )


def magnitude(value: float | None, imaginary: float | None) -> float | None:
    """Return a value; for an unbalance, which is complex, its magnitude."""
    return value if value is None or imaginary is None else math.hypot(value, imaginary)


def quality_of(accepted: bool, value: float | None) -> str:
    """Return whether a value is to be trusted, in the words of trends."""
    if not accepted:
        return NOT_ACCEPTED
    return NOT_ESTIMABLE if value is None or not math.isfinite(value) else ACCEPTED


def _points(machine_id: str, scope: str, found: Mapping[str, Columns], points: Mapping[str, Chosen]) -> Iterator[str | None]:
    for name, columns in found.items():
        history = columns.history
        for at in points[name].index.tolist():
            yield line(
                MEASUREMENT,
                _tags(machine_id, name, history.unit, str(history.run_kind[at]), str(columns.quality[at]), scope),
                {
                    "value": float(columns.value[at]),
                    "standard_error": float(columns.standard_error[at]),
                    "lower": float(history.lower[at]),
                    "upper": float(history.upper[at]),
                    "identification": int(history.identification[at]),
                },
                int(history.measured_at[at]),
            )


def _tags(machine: str, parameter: str, unit: str | None, run_kind: str, quality: str, scope: str) -> dict[str, str]:
    told = {"machine": machine, "parameter": parameter, "unit": unit or "", "run_kind": run_kind}
    return told | {"quality": quality, "scope": scope}


def _text(lines: Iterable[str | None]) -> bytes:
    return "".join(f"{one}\n" for one in lines if one is not None).encode()
