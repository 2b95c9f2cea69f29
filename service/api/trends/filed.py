"""Serves what was identified, machine after machine, in the order in which it was filed: for readers that want what is new."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Any

import msgspec
from fastapi import APIRouter, Query, Request, Response
from pydantic import BaseModel, Field
from sqlalchemy import Row

from service.api.conventions.dependencies import Reading
from service.api.conventions.formats import CSV, MEDIA_TYPES, PARQUET, csv_bytes, negotiated_format, parquet_bytes
from service.api.conventions.problems import RESPONSES
from service.api.conventions.values import rfc3339_text
from service.api.trends.trend_lines import LINES, TrendFormat, filed_lines, magnitude, quality_of
from service.security.requirement import VIEWER
from storage.clock import now
from storage.findings import filed_estimates
from storage.tables.findings import IdentificationRow

router = APIRouter(tags=["trends"], responses=RESPONSES, dependencies=[VIEWER])

LARGEST_COUNT = 200
"""Most identifications in one answer; one has some hundred values."""
DAY_NS = 86_400_000_000_000
NEXT = "Rundown-After"
"""Header that says what to ask with next time."""


class FiledEstimate(BaseModel):
    """A value of an identification, in SI."""

    identification: int
    machine: str
    parameter: str
    unit: str
    measured_at: str = Field(description="when the run ended, RFC 3339 in UTC")
    computed_at: str
    scope: str = Field(description="run or gathered")
    run_kind: str
    quality: str = Field(description="accepted, not_accepted or not_estimable, as in trends")
    value: float | None = Field(description="of an unbalance its magnitude")
    standard_error: float | None
    lower: float | None = Field(description="of the 95 % interval")
    upper: float | None
    real: float | None = Field(description="of an unbalance; else null")
    imaginary: float | None


class FiledEstimates(BaseModel):
    """Values of some identifications, and where the next ones begin."""

    after: int = Field(description="ask with it for what comes then; as it was asked where nothing is new")
    more: bool = Field(description="whether more is there already")
    estimates: list[FiledEstimate]


@router.get(
    "/estimates",
    operation_id="list_estimates",
    response_class=Response,
    responses={
        200: {
            "model": FiledEstimates,
            "content": {
                CSV: {"schema": {"type": "string"}},
                PARQUET: {"schema": {"type": "string", "format": "binary"}},
                "text/plain": {"schema": {"type": "string"}},
            },
        }
    },
)
def list_estimates(
    request: Request,
    session: Reading,
    after: Annotated[int, Query(ge=0, le=2**62, description="number of the last identification that is known")] = 0,
    limit: Annotated[int, Query(ge=1, le=LARGEST_COUNT, description="identifications in the answer")] = 50,
    within_days: Annotated[float | None, Query(gt=0, le=3660, description="only what was computed in the last days")] = None,
    newest: Annotated[
        bool, Query(description="where there is more than `limit`, the newest of it: for readers that keep no cursor")
    ] = False,
    chosen: Annotated[
        TrendFormat | None,
        Query(alias="format", description="influx: line protocol; by default what the Accept header prefers"),
    ] = None,
) -> Response:
    """List the values of identifications with a higher number than `after`, of all machines, in the order of their numbers.

    The header Rundown-After, and `after` of JSON, is what to ask with next. A value appears two seconds after it was computed.
    """
    wanted = "influx" if chosen == "influx" else negotiated_format(request, chosen)
    since = None if within_days is None else now() - int(within_days * DAY_NS)
    found = filed_estimates.filed(session, after=after, limit=limit + 1, since=since, newest=newest)
    rows = {one.id: one for one in (found[-limit:] if newest else found[:limit])}
    values = filed_estimates.values_of(session, list(rows))
    last = max(rows, default=after)
    headers = {NEXT: str(last), "Vary": "Accept"}
    if wanted == "influx":
        return Response(filed_lines(rows, values), media_type=LINES, headers=headers)
    if wanted == "json":
        told = [_estimate_row(rows[one.identification], one) for one in values]
        body = msgspec.json.encode({"after": last, "more": len(found) > limit, "estimates": told})
    else:
        columns = _columns(rows, values)
        body = csv_bytes(columns) if wanted == "csv" else parquet_bytes(columns, times=("measured_at", "computed_at"))
    return Response(body, media_type=MEDIA_TYPES[wanted], headers=headers)


def _estimate_row(row: IdentificationRow, one: Row[Any]) -> dict[str, Any]:
    unbalance = one.imaginary is not None
    return {
        "identification": row.id,
        "machine": row.machine_id,
        "parameter": one.parameter,
        "unit": one.unit,
        "measured_at": rfc3339_text(row.measured_at),
        "computed_at": rfc3339_text(row.computed_at),
        "scope": row.scope,
        "run_kind": row.run_kind,
        "quality": quality_of(row.accepted, one.value),
        "value": magnitude(one.value, one.imaginary),
        "standard_error": None if unbalance else one.standard_error,
        "lower": one.lower,
        "upper": one.upper,
        "real": one.value if unbalance else None,
        "imaginary": one.imaginary,
    }


def _columns(rows: Mapping[int, IdentificationRow], values: Sequence[Row[Any]]) -> dict[str, list[Any]]:
    """Return the values column by column; the columns are there without rows, too."""
    columns: dict[str, list[Any]] = {name: [] for name in FiledEstimate.model_fields}
    for one in values:
        for name, value in _estimate_row(rows[one.identification], one).items():
            columns[name].append(value)
    return columns
