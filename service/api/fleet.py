"""All machines at a glance, for an overview."""

from datetime import datetime, timedelta
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request, Response
from pydantic import BaseModel, Field

from estimator.operating_state import Mode
from estimator.units import rad_per_s_to_rpm
from service.alert_life import Severity
from service.api.access import Reading, instant
from service.api.machine_list import MachineList
from service.api.machine_state import OpenRun, progress
from service.api.paging import ByName
from service.api.problems import RESPONSES
from service.api.rendering import time_or_none
from service.api.times import Time
from service.collection import Standing
from storage import fleet
from storage.clock import now, to_datetime
from storage.fleet import IdentificationGlance, MachineGlance, RunGlance
from storage.runs import OPEN

router = APIRouter(tags=["machines"], responses=RESPONSES)

LABELS = [(severity, severity.label) for severity in Severity]
A_DAY = int(timedelta(days=1).total_seconds()) * 1_000_000_000


class LastRun(BaseModel):
    """The newest run, open or not."""

    id: int
    kind: str
    state: str
    started_at: datetime
    ended_at: datetime | None


class LastIdentification(BaseModel):
    """The newest identification by the time of its measurement."""

    id: int
    measured_at: datetime
    accepted: bool
    verdict: str


class Happened(BaseModel):
    """How much happened since the time asked for."""

    runs: int = Field(description="that began")
    identifications: int = Field(description="that were computed")
    alert_events: int
    revisions: int = Field(description="of the document")
    timeline: int = Field(description="entries")


class FleetMachine(BaseModel):
    """A machine at a glance."""

    id: str
    plant: str
    name: str
    revision: int
    state: Mode = Field(description="unknown before the first sample and after a silence")
    state_since: datetime | None
    speed_rpm: float | None = Field(description="of the newest sample")
    newest_sample_at: datetime | None
    open_run: OpenRun | None
    last_run: LastRun | None
    last_identification: LastIdentification | None
    open_alerts: dict[str, int] = Field(description="by severity: alert, danger")
    unacknowledged: int = Field(description="open alerts that nobody has seen")
    happened: Happened


class Fleet(BaseModel):
    """All machines at a glance, by id."""

    since: datetime
    machines: list[FleetMachine]


@router.get("/fleet", operation_id="read_fleet", response_model=Fleet)
def read_fleet(
    request: Request,
    session: Reading,
    paging: ByName,
    since: Annotated[Time | None, Query(description="RFC 3339; what happened from then on; by default a day ago")] = None,
) -> Response:
    """What each machine is doing, its last run, its open alerts, and what happened to it since a time."""
    begin = now() - A_DAY if since is None else instant(since)
    known: MachineList = request.app.state.machine_list
    machines = paging.page(known.page(session, limit=paging.wanted, after=paging.after), lambda one: (one.id,))
    seen = fleet.glances(session, machines, since=begin)
    return paging.json({"since": to_datetime(begin), "machines": [_machine(one) for one in seen]})


def _machine(one: MachineGlance) -> dict[str, Any]:
    # Encoded without a model: a thousand of them would be looked at field by field.
    standing = None if one.collector is None else Standing.restored(one.collector)
    readings = None if standing is None else standing.operating.sweep.readings
    return {
        "id": one.machine.id,
        "plant": one.machine.plant,
        "name": one.machine.name,
        "revision": one.machine.revision,
        "state": "unknown" if standing is None else standing.operating.mode,
        "state_since": time_or_none(standing.operating.since or None) if standing is not None else None,
        "speed_rpm": rad_per_s_to_rpm(readings.last_speed)
        if readings is not None and readings.last_time is not None
        else None,
        "newest_sample_at": None if standing is None else to_datetime(standing.seen),
        "open_run": _open_run(one, standing),
        "last_run": _last_run(one.last_run),
        "last_identification": _last_identification(one.last_identification),
        "open_alerts": {label: one.open_alerts.get(severity, 0) for severity, label in LABELS},
        "unacknowledged": one.unacknowledged,
        "happened": one.since,
    }


def _open_run(one: MachineGlance, standing: Standing | None) -> dict[str, Any] | None:
    run = one.last_run
    if standing is None or run is None or run.state != OPEN:
        return None
    part = progress(run.kind, standing, minimum_rpm=one.machine.minimum_rpm, maximum_rpm=one.machine.maximum_rpm)
    return {"id": run.id, "kind": run.kind, "started_at": to_datetime(run.time_first), "progress": part}


def _last_run(run: RunGlance | None) -> dict[str, Any] | None:
    if run is None:
        return None
    times = {"started_at": to_datetime(run.time_first), "ended_at": time_or_none(run.time_last)}
    return {"id": run.id, "kind": run.kind, "state": run.state} | times


def _last_identification(last: IdentificationGlance | None) -> dict[str, Any] | None:
    if last is None:
        return None
    outcome = {"accepted": last.accepted, "verdict": last.verdict}
    return {"id": last.id, "measured_at": to_datetime(last.measured_at)} | outcome
