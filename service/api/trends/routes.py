"""Serves parameter trends: the histories of several parameters, in columns, with their baselines."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal

import msgspec
from fastapi import APIRouter, Query, Request, Response
from pydantic import BaseModel, Field

from service.api.cache.response_cache import Cached
from service.api.conventions.dependencies import MachineId, Period
from service.api.conventions.formats import CSV, MEDIA_TYPES, PARQUET, Format, csv_bytes, negotiated_format, parquet_bytes
from service.api.conventions.parameter_units import ParameterUnitChoice
from service.api.conventions.problems import RESPONSES
from service.api.conventions.values import rfc3339_text
from service.api.trends.columns import Columns, HistoryCache, baseline_columns, complex_parts, in_time_range, value_columns
from service.api.trends.downsampling import Chosen
from service.api.trends.trend_lines import LINES, TrendFormat, trend_lines
from service.api.trends.units import in_units
from service.monitoring.trend_bands import BaselineBand
from service.security.requirement import VIEWER
from storage.findings import trends

router = APIRouter(tags=["trends"], responses=RESPONSES, dependencies=[VIEWER])

MAXIMUM_PARAMETERS = 100
MAXIMUM_POINTS = 20_000

Scope = Annotated[Literal["run", "gathered"], Query(description="of single runs, or of the newest runs together")]
MaxPoints = Annotated[
    int,
    Query(
        ge=10, le=MAXIMUM_POINTS, description="most points of each series; a longer one is thinned out, which the answer says"
    ),
]
Parameters = Annotated[
    list[Annotated[str, Field(max_length=160, pattern=r"^\w+\.\S+$")]],
    Query(
        min_length=1,
        max_length=MAXIMUM_PARAMETERS,
        description="such as bearing.B1.kxx or critical_speed.1; several in one question",
    ),
]
FormatChoice = Annotated[
    TrendFormat | None, Query(alias="format", description="influx: line protocol; by default what the Accept header prefers")
]


class DownSampling(BaseModel):
    """Method by which the points of a series were chosen."""

    method: Literal["none", "min-max-per-bucket"] = Field(
        description="none: all. min-max-per-bucket: the first, the last, and of each of equal stretches of time the lowest "
        "and the highest value of each kind of run, accepted and not accepted apart; every point shown is one that was "
        "identified"
    )
    points: int = Field(description="how many there are in the time range")


class TrendBaseline(BaseModel):
    """Range of 95 % of the estimates of an unchanged machine, by the baseline of a part of the trend."""

    run_kind: str = Field(description="of the runs that it is for")
    since: str = Field(description="measured_at of the first identification that it is for")
    until: str | None = Field(description="from here on another one; null for the one in force now")
    centre: float
    lower: float
    upper: float
    identifications: list[int] = Field(description="that made it")


class Series(BaseModel):
    """History of one parameter or derived quantity; all lists have one entry per point, oldest first."""

    parameter: str
    unit: str = Field(description="of all its values")
    down_sampling: DownSampling
    baselines: list[TrendBaseline] = Field(description="empty until a baseline is complete, and for gathered runs")
    measured_at: list[str] = Field(description="when the run ended, RFC 3339 in UTC")
    computed_at: list[str] = Field(description="when it was identified")
    value: list[float | None] = Field(description="of an unbalance its magnitude")
    standard_error: list[float | None] = Field(
        description="null for an unbalance and for derived quantities, of which the interval tells"
    )
    lower: list[float | None] = Field(description="of the 95 % interval")
    upper: list[float | None]
    quality: list[str] = Field(
        description="accepted; not_accepted: the model did not fit the run, the value is not to be trusted; not_estimable: "
        "the run does not determine this parameter, the value is null"
    )
    run_kind: list[str]
    identification: list[int]
    real: list[float | None] | None = Field(description="of an unbalance, along the keyphasor mark; else null")
    imaginary: list[float | None] | None = Field(description="of an unbalance, a quarter turn on from +x to +y; else null")
    angle_deg: list[float | None] | None = Field(
        description="of an unbalance, from the keyphasor mark on, from +x to +y, 0 to 360; else null"
    )
    angle_half_width_deg: list[float | None] | None = Field(
        description="of the angle's 95 % interval; 180: any angle is possible"
    )


class Trends(BaseModel):
    """Histories of parameters of one machine."""

    machine: str
    scope: str
    series: list[Series]


@router.get(
    "/machines/{machine_id}/trends",
    operation_id="read_trends",
    response_class=Response,
    responses={
        200: {
            "model": Trends,
            "content": {
                CSV: {"schema": {"type": "string"}},
                PARQUET: {"schema": {"type": "string", "format": "binary"}},
                "text/plain": {"schema": {"type": "string"}},
            },
        }
    },
)
async def read_trends(
    request: Request,
    cache: Cached,
    machine_id: MachineId,
    period: Period,
    parameter: Parameters,
    units: ParameterUnitChoice,
    max_points: MaxPoints = 5000,
    scope: Scope = "run",
    chosen: FormatChoice = None,
) -> Response:
    """Read the history of one or more parameters, or quantities derived from them, over a time range, oldest first.

    The answer is JSON, CSV, Parquet or InfluxDB line protocol. CSV and Parquet are one table with a column `parameter`; each
    point has the baseline's band beside it, and each row names its series' method of downsampling. The series of a parameter
    that the machine has and that was never identified is empty; one that none of the newest 20 revisions of its document
    has is not found.
    """
    wanted: TrendFormat = "influx" if chosen == "influx" else negotiated_format(request, chosen)
    kept: HistoryCache = request.app.state.histories
    names = list(dict.fromkeys(parameter))

    def read() -> Response:
        stored = kept.columns(machine_id, names, scope=scope)
        found = {name: in_units(columns, units) for name, columns in stored.items()}
        points = {
            name: in_time_range(columns, first=period.first, last=period.last, most=max_points)
            for name, columns in found.items()
        }
        if wanted == "influx":
            return Response(trend_lines(machine_id, scope, found, points), media_type=LINES, headers={"Vary": "Accept"})
        body = _json(machine_id, scope, found, points) if wanted == "json" else _file(wanted, found, points)
        return Response(body, media_type=MEDIA_TYPES[wanted], headers={"Vary": "Accept"})

    return await cache.answer(request, trends.TABLES, read)


def _json(machine_id: str, scope: str, found: Mapping[str, Columns], points: Mapping[str, Chosen]) -> bytes:
    series = [_series(name, columns, points[name]) for name, columns in found.items()]
    return msgspec.json.encode({"machine": machine_id, "scope": scope, "series": series})


def _file(wanted: Format, found: Mapping[str, Columns], points: Mapping[str, Chosen]) -> bytes:
    rows = _rows(found, points)
    return csv_bytes(rows) if wanted == "csv" else parquet_bytes(rows, times=("measured_at", "computed_at"))


def _series(name: str, columns: Columns, chosen: Chosen) -> dict[str, Any]:
    # Encoded without a model: validating thousands of points takes too long.
    head = {"parameter": name, "unit": columns.history.unit}
    down_sampling = {"method": chosen.method, "points": chosen.points}
    bands = [_baseline(one) for one in columns.baselines]
    return (
        head
        | {"down_sampling": down_sampling, "baselines": bands}
        | value_columns(columns, chosen)
        | complex_parts(columns, chosen)
    )


def _baseline(one: BaselineBand) -> dict[str, Any]:
    return {
        "run_kind": one.run_kind,
        "since": rfc3339_text(one.since),
        "until": None if one.until is None else rfc3339_text(one.until),
        "centre": one.band.centre,
        "lower": one.band.lower,
        "upper": one.band.upper,
        "identifications": one.identifications,
    }


def _rows(found: Mapping[str, Columns], points: Mapping[str, Chosen]) -> dict[str, list[Any]]:
    """Return the rows of all series, one series below the other."""
    whole: dict[str, list[Any]] = {}
    for name, columns in found.items():
        chosen = points[name]
        count = len(chosen.index)
        components = {
            part: [None] * count if values is None else values for part, values in complex_parts(columns, chosen).items()
        }
        rows: dict[str, list[Any]] = {"parameter": [name] * count, "unit": [columns.history.unit] * count}
        thinned: dict[str, list[Any]] = {"down_sampling": [chosen.method] * count, "points": [chosen.points] * count}
        for column, values in (
            rows | value_columns(columns, chosen) | components | baseline_columns(columns, chosen) | thinned
        ).items():
            whole.setdefault(column, []).extend(values)
    return whole
