"""Serves samples and runs."""

from collections.abc import Sequence
from typing import Annotated, Literal

from fastapi import APIRouter, Query, Request, Response, status
from pydantic import BeforeValidator, Field

from service.api.conventions.dependencies import LAST_INSTANT, MICROSECOND, MachineId, Number, Period, Reading, database
from service.api.conventions.formats import CSV, csv_bytes
from service.api.conventions.paging import ByTime
from service.api.conventions.problems import RESPONSES
from service.api.conventions.units import UnitsIfAsked
from service.api.measurements import rendering, schemas
from service.api.measurements.corrections import SlowRollQuery, corrected_phasors, most_samples, run_samples
from service.runs.dwell_runs import add_dwells, read_dwells
from service.security.requirement import ANALYST, VIEWER
from storage.clock import from_datetime
from storage.machines import machines
from storage.measurements import runs, samples

router = APIRouter(tags=["measurements"], responses=RESPONSES, dependencies=[VIEWER])

LARGEST_SAMPLE_COUNT = 10_000


def _split_values(given: Sequence[str]) -> list[str]:
    """Split values that come in one parameter with commas between, or in several."""
    return [name for one in given for name in one.split(",")]


Include = Annotated[
    tuple[schemas.PhasorExtra, ...],
    Field(max_length=5),
    BeforeValidator(_split_values),
    Query(description="what else the sources send of each value; repeated, or with commas between"),
]


@router.get(
    "/machines/{machine_id}/samples",
    operation_id="read_samples",
    response_model=schemas.Phasors,
    responses={200: {"content": {CSV: {"schema": {"type": "string"}}}}},
)
def read_samples(
    session: Reading,
    machine_id: MachineId,
    period: Period,
    units: UnitsIfAsked,
    limit: Annotated[int, Query(ge=1, le=LARGEST_SAMPLE_COUNT)] = 1000,
    slow_roll: SlowRollQuery = "none",
    include: Include = (),
    revision: Annotated[int | None, Query(ge=1, le=2**31, description="of the document; by default the one in force")] = None,
    form: Annotated[
        Literal["json", "csv"],
        Query(alias="format", description="csv: a row for each sample and channel, for tools that plot rows"),
    ] = "json",
) -> schemas.Phasors | Response:
    """Read the newest samples of a time range, as they were received, oldest of them first.

    They are those of the document in force, or of a chosen revision, and of all revisions that describe the same machine with
    the same channels and operating conditions; the answer lists these. Name any other revision to read its samples. An answer
    with `limit` samples may be incomplete: ask again with `to` before the first of them for older ones.
    """
    chosen = revision or machines.get(session, machine_id).revision
    machine = machines.document(session, machine_id, chosen)
    alike = machines.revisions_with_same_channels(session, machine_id, chosen)
    newest = samples.latest(
        session,
        machine_id,
        revision=chosen,
        also=alike,
        channels=len(machine.probes),
        count=min(limit, most_samples(machine, units, include) + 1),  # more are refused, and need not be read
        first=period.first,
        last=period.last,
    )
    answer = corrected_phasors(session, machine, newest, slow_roll, units, include)
    if form == "csv":
        return Response(csv_bytes(rendering.channel_rows(answer)), media_type=CSV)
    return answer.model_copy(update={"revisions": alike})


@router.get("/machines/{machine_id}/runs", operation_id="list_runs")
def list_runs(session: Reading, machine_id: MachineId, period: Period, paging: ByTime) -> list[schemas.Run]:
    """List run-ups, run-downs and runs of dwells that began in a time range, newest first."""
    machines.get(session, machine_id)
    rows = runs.of_machine(session, machine_id, first=period.first, last=period.last, limit=paging.wanted, after=paging.after)
    return [rendering.run(row) for row in paging.page(rows, lambda row: (row.time_first, row.id))]


@router.post(
    "/machines/{machine_id}/runs", operation_id="make_run", status_code=status.HTTP_201_CREATED, dependencies=[ANALYST]
)
def make_run(request: Request, response: Response, machine_id: MachineId, body: schemas.DwellsIn) -> schemas.Run:
    """Make a run of the dwells at constant speed in a time range, for calibrations (`steady`) and balancings.

    Sweeps become runs by themselves; a machine that was held at some speeds makes none. Samples taken while the speed changed
    between dwells are left out. The run is kind `dwells`, and is identified on request only.
    """
    last = min(LAST_INSTANT, from_datetime(body.last) + MICROSECOND - 1)
    with database(request).reading() as session:
        found = read_dwells(session, machine_id, first=from_datetime(body.first), last=last)
    with database(request).transaction() as session:
        row = add_dwells(session, found, by=body.by)
        response.headers["Location"] = f"/api/v1/runs/{row.id}"
        return rendering.run(row)


@router.get("/runs/{run_id}", operation_id="read_run")
def read_run(session: Reading, run_id: Number) -> schemas.Run:
    """Read one run."""
    return rendering.run(runs.get(session, run_id))


@router.get("/runs/{run_id}/phasors", operation_id="read_run_phasors")
def read_run_phasors(
    session: Reading, run_id: Number, units: UnitsIfAsked, slow_roll: SlowRollQuery = "none", include: Include = ()
) -> schemas.Phasors:
    """Read the run's 1× phasors over speed: its Bode data. Of an open run, those collected so far."""
    machine, held = run_samples(session, run_id)
    return corrected_phasors(session, machine, held, slow_roll, units, include)
