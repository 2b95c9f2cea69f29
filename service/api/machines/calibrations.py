"""Calibrations of a machine's channels. The timeline shows them too: a step in a trend may come from the probe."""

from datetime import datetime
from typing import Annotated

from fastapi import APIRouter, Query, Request, status
from pydantic import BaseModel, ConfigDict, Field

from estimator.field_types import Identifier
from service.api.conventions.dependencies import MachineId, Period, Reading, database, instant
from service.api.conventions.fields import Moment, NonBlankText
from service.api.conventions.paging import ByTime
from service.api.conventions.problems import RESPONSES, Unsuitable
from service.security.principal import Author
from service.security.requirement import ANALYST, VIEWER
from storage.clock import is_ahead, to_datetime
from storage.machines import calibrations, machines, timeline
from storage.tables.machines import CalibrationRow

router = APIRouter(prefix="/machines/{machine_id}/calibrations", tags=["machines"], responses=RESPONSES, dependencies=[VIEWER])

CALIBRATION = "calibration"
"""Kind of a calibration's entry on the timeline."""


class CalibrationIn(BaseModel):
    """A calibration of a channel. A changed sensitivity is not applied here: revise the machine's document."""

    model_config = ConfigDict(extra="forbid")

    channel: Identifier = Field(description="of a probe in the document in force")
    at: Moment = Field(description="when it was calibrated")
    certificate: NonBlankText = Field(description="what it says: number, laboratory, sensitivity found, uncertainty")
    by: Author


class CalibrationOut(BaseModel):
    """A stored calibration of a channel."""

    id: int
    machine: str
    channel: str
    at: datetime
    certificate: str
    by: str
    created_at: datetime


@router.get("", operation_id="list_calibrations")
def list_calibrations(
    session: Reading,
    machine_id: MachineId,
    period: Period,
    paging: ByTime,
    channel: Annotated[Identifier | None, Query(description="only of this channel")] = None,
) -> list[CalibrationOut]:
    """List calibrations in a time range, newest first, including those of channels that no longer exist."""
    machines.get(session, machine_id)
    rows = calibrations.of_machine(
        session, machine_id, channel=channel, first=period.first, last=period.last, limit=paging.wanted, after=paging.after
    )
    return [_rendered(row) for row in paging.page(rows, lambda row: (row.at, row.id))]


@router.post("", operation_id="add_calibration", status_code=status.HTTP_201_CREATED, dependencies=[ANALYST])
def add_calibration(request: Request, machine_id: MachineId, body: CalibrationIn) -> CalibrationOut:
    """Record that a channel was calibrated; the entry is never changed or deleted."""
    at = instant(body.at)
    if is_ahead(at):
        raise Unsuitable("a calibration is noted when it was done, not in the future: note the plan as a note")
    with database(request).transaction() as session:
        channels = machines.document(session, machine_id).channels
        if body.channel not in channels:
            raise Unsuitable(f"machine '{machine_id}' has no channel {body.channel}; it has {', '.join(channels)}")
        row = calibrations.add(session, machine_id, channel=body.channel, at=at, certificate=body.certificate, by=body.by)
        words = f"{body.channel}: {body.certificate}"
        timeline.add(session, machine_id, at=at, kind=CALIBRATION, text=words, by=body.by)
        return _rendered(row)


def _rendered(row: CalibrationRow) -> CalibrationOut:
    return CalibrationOut(
        id=row.id,
        machine=row.machine_id,
        channel=row.channel,
        at=to_datetime(row.at),
        certificate=row.certificate,
        by=row.by,
        created_at=to_datetime(row.created_at),
    )
