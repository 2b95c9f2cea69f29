"""Serves each machine's current state and its earlier ones."""

from datetime import datetime
from typing import Literal

import numpy as np
from fastapi import APIRouter
from pydantic import BaseModel, Field
from sqlalchemy.orm import Session

from estimator.machine.document import Machine
from estimator.machine.rules import SpeedRange
from estimator.machine.speed_units import outside_speed_range, short_of_speed_range
from estimator.runs.operating_state import Mode
from estimator.units import rad_per_s_to_rpm
from service.api.conventions.dependencies import MachineId, Period, Reading
from service.api.conventions.paging import ByTime
from service.api.conventions.problems import RESPONSES
from service.api.conventions.values import direction
from service.runs.collection_state import CollectionState, state_of
from service.security.requirement import VIEWER
from storage.clock import to_datetime
from storage.machines import machines
from storage.measurements import runs

router = APIRouter(prefix="/machines", tags=["machines"], responses=RESPONSES, dependencies=[VIEWER])


class OpenRun(BaseModel):
    """The run that is being collected."""

    id: int
    kind: str
    started_at: datetime
    progress: float = Field(description="part of the speed range that lies behind it, 0 to 1")


class MachineState(BaseModel):
    """State of a machine by its newest samples."""

    machine: str
    state: Mode = Field(description="unknown before the first sample and after a silence")
    since: datetime | None
    speed_rpm: float | None = Field(description="of the newest sample")
    direction: Literal["positive", "negative"] | None = Field(description="positive turns +x towards +y")
    newest_sample_at: datetime | None
    run: OpenRun | None
    outside_speed_range: str | None = Field(
        None,
        description="what is probably wrong where it turns, but never was in its document's speed range; or, while it has no "
        "run, how small a part of that it covered",
    )
    late_samples_waiting: int = Field(0, description="they came late, are stored, and will be sorted into their runs")


class PastState(BaseModel):
    """A state that a machine entered."""

    state: Mode
    since: datetime
    speed_rpm: float | None = Field(description="when it was noticed")


@router.get("/{machine_id}/state", operation_id="read_machine_state")
def read_machine_state(session: Reading, machine_id: MachineId) -> MachineState:
    """Read the state: stopped, slow roll, run-up, at speed, run-down or trip, with the progress of the open run."""
    machine = machines.document(session, machine_id)
    now = state_of(session, machine_id)
    if now is None:
        return MachineState(
            machine=machine_id, state="unknown", since=None, speed_rpm=None, direction=None, newest_sample_at=None, run=None
        )
    last = now.operating.sweep.readings.last_time
    return MachineState(
        machine=machine_id,
        state=now.operating.mode,
        since=to_datetime(now.operating.since) if now.operating.since else None,
        speed_rpm=rad_per_s_to_rpm(now.operating.sweep.readings.last_speed) if last is not None else None,
        direction=direction(now.direction),
        newest_sample_at=to_datetime(now.seen),
        run=_open_run(session, machine, now),
        outside_speed_range=why_without_run(
            machine.speed_range, now, has_runs=bool(runs.of_machine(session, machine_id, limit=1))
        ),
        late_samples_waiting=sum(count for _, _, _, count in now.late),
    )


def progress(kind: str, now: CollectionState, *, minimum_rpm: float, maximum_rpm: float) -> float:
    """Return the part of the speed range that a sweep has covered, 0 to 1."""
    part = (rad_per_s_to_rpm(now.operating.sweep.believed_speed) - minimum_rpm) / (maximum_rpm - minimum_rpm)
    part = min(1.0, max(0.0, part))
    return part if kind == "run-up" else 1.0 - part


def why_without_run(limits: SpeedRange, now: CollectionState, *, has_runs: bool) -> str | None:
    """Return why a machine that turns has no run; None where that is not known, or it has one."""
    speeds = np.array([now.slowest, now.fastest])
    outside = outside_speed_range(limits, speeds)
    if outside or has_runs:
        return outside or None
    return short_of_speed_range(limits, speeds) or None


def _open_run(session: Session, machine: Machine, now: CollectionState) -> OpenRun | None:
    row = runs.open_run_of(session, machine.id)
    if row is None:
        return None
    limits = machine.speed_range
    part = progress(row.kind, now, minimum_rpm=limits.minimum_rpm, maximum_rpm=limits.maximum_rpm)
    return OpenRun(id=row.id, kind=row.kind, started_at=to_datetime(row.time_first), progress=part)


@router.get("/{machine_id}/states", operation_id="list_machine_states")
def list_machine_states(session: Reading, machine_id: MachineId, period: Period, paging: ByTime) -> list[PastState]:
    """List states entered in a time range, newest first. Late samples change runs, not this history."""
    machines.get(session, machine_id)
    rows = runs.states(session, machine_id, first=period.first, last=period.last, limit=paging.wanted, after=paging.after)
    return [
        PastState.model_validate(
            {
                "state": row.mode,
                "since": to_datetime(row.since),
                "speed_rpm": None if row.speed is None else rad_per_s_to_rpm(row.speed),
            }
        )
        for row in paging.page(rows, lambda row: (row.since, row.id))
    ]
