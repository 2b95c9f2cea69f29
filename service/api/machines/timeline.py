"""Serves the notes, markers and maintenances on machines' timelines."""

from fastapi import APIRouter, Request, status

from service.api.conventions.dependencies import MachineId, Period, Reading, database, instant
from service.api.conventions.paging import ByTime
from service.api.conventions.problems import RESPONSES
from service.api.machines import timeline_rendering as rendering
from service.api.machines import timeline_schemas as schemas
from service.monitoring import baseline_changes
from service.security.requirement import ANALYST, VIEWER
from storage.machines import machines, timeline

router = APIRouter(tags=["alerts"], responses=RESPONSES, dependencies=[VIEWER])


@router.get("/machines/{machine_id}/timeline", operation_id="read_timeline")
def read_timeline(session: Reading, machine_id: MachineId, period: Period, paging: ByTime) -> list[schemas.TimelineOut]:
    """Read notes and markers of a machine, newest first."""
    machines.get(session, machine_id)
    rows = timeline.of_machine(
        session, machine_id, first=period.first, last=period.last, limit=paging.wanted, after=paging.after
    )
    return [rendering.timeline_entry(row) for row in paging.page(rows, lambda row: (row.at, row.id))]


@router.post(
    "/machines/{machine_id}/timeline",
    operation_id="add_timeline_entry",
    dependencies=[ANALYST],
    status_code=status.HTTP_201_CREATED,
)
def add_timeline_entry(request: Request, machine_id: MachineId, body: schemas.TimelineIn) -> schemas.TimelineOut:
    """Add a note, a marker or a maintenance to a machine's timeline; a maintenance begins a new baseline."""
    with database(request).transaction() as session:
        machines.get(session, machine_id)
        row = baseline_changes.note(session, machine_id, at=instant(body.at), kind=body.kind, text=body.text, by=body.by)
        return rendering.timeline_entry(row)
