"""Serves the overview of all machines."""

import math
from datetime import datetime, timedelta
from typing import Annotated

from fastapi import APIRouter, Query, Request, Response
from pydantic import BaseModel, Field

from estimator.runs.operating_state import Mode
from service.api.cache.response_cache import Cached
from service.api.conventions.dependencies import database, instant
from service.api.conventions.paging import ByName
from service.api.conventions.problems import RESPONSES
from service.api.conventions.times import Time
from service.api.machines.machine_list import MachineList
from service.api.machines.machine_state import OpenRun
from service.api.machines.overview import Overview
from service.security.requirement import VIEWER
from storage.clock import now, to_datetime
from storage.machines import fleet

router = APIRouter(tags=["machines"], responses=RESPONSES, dependencies=[VIEWER])

A_SECOND = 1_000_000_000
A_MINUTE = 60 * A_SECOND
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
    """Counts of events since the requested time."""

    runs: int = Field(description="that began")
    identifications: int = Field(description="that were computed")
    alert_events: int
    revisions: int = Field(description="of the document")
    timeline: int = Field(description="entries")
    refused: int = Field(description="entries of the quarantine: messages and values of its sources that were not taken")


class FirstAlert(BaseModel):
    """The open alert to look at first: one that waits for a person, then the worst, then the newest."""

    id: int
    severity: str
    rule: str
    element: str
    state: str


class FailedJob(BaseModel):
    """An identification that failed, after which none of the machine has ended well."""

    id: int
    error: str | None


class BeyondDanger(BaseModel):
    """A 1× beyond the document's danger limit, as measured: at running speed in three samples on end, or for a minute at any.

    It stays, through a trip and a standstill, until the machine has run below the limit at running speed for five minutes.
    """

    channel: str
    amplitude_um_pp: float = Field(description="the largest while it was beyond")
    danger_um_pp: float
    speed_rpm: float = Field(description="at that amplitude")
    first_at: datetime
    last_at: datetime


class FleetMachine(BaseModel):
    """A machine's row in the overview."""

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
    first_alert: FirstAlert | None
    outside_speed_range: str | None = Field(description="why it has no run, where it turns outside of its speed range")
    vibration_beyond_danger: BeyondDanger | None
    failed_job: FailedJob | None
    happened: Happened


class Fleet(BaseModel):
    """All machines by id, each with its row."""

    since: datetime
    machines: list[FleetMachine]


@router.get("/fleet", operation_id="read_fleet", response_model=Fleet)
async def read_fleet(
    request: Request,
    cache: Cached,
    paging: ByName,
    since: Annotated[
        Time | None, Query(description="RFC 3339; what happened from then on; by default a day ago, to the minute")
    ] = None,
) -> Response:
    """List every machine with its state, last run, open alerts, and the events since a time.

    Speeds, states and progress may be half a second behind what is stored, `refused` and
    `failed_job` a minute; everything else is current.
    """
    asked_at = now()
    begin = (asked_at - A_DAY) // A_MINUTE * A_MINUTE if since is None else instant(since)
    known: MachineList = request.app.state.machine_list
    overview: Overview = request.app.state.overview

    def read() -> Response:
        with database(request).reading() as session:
            machines = paging.page(known.page(session, limit=paging.wanted, after=paging.after), lambda one: (one.id,))
            return paging.json({"since": to_datetime(begin), "machines": overview.rows(session, machines, since=begin)})

    same_for_s = math.inf if since is not None else (begin + A_DAY + A_MINUTE - asked_at) / A_SECOND
    return await cache.answer(request, fleet.TABLES, read, lately=("collectors",), apart=begin, apart_for_s=same_for_s)
