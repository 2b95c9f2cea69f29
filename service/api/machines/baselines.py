"""Serves the baselines that machines are compared with."""

from fastapi import APIRouter, Request, status

from service.api.conventions.dependencies import MachineId, Reading, database, instant
from service.api.conventions.paging import ByTime
from service.api.conventions.problems import CHANGES, RESPONSES
from service.api.machines import timeline_rendering as rendering
from service.api.machines import timeline_schemas as schemas
from service.monitoring import baseline_changes
from service.security.requirement import ANALYST, VIEWER
from storage.machines import baselines, machines

router = APIRouter(tags=["machines"], responses=RESPONSES, dependencies=[VIEWER])


@router.get("/machines/{machine_id}/baselines", operation_id="list_baselines")
def list_baselines(session: Reading, machine_id: MachineId, paging: ByTime) -> list[schemas.BaselineOut]:
    """List baselines begun by a maintenance or a person, newest first.

    Before the first, the machine's first runs serve as baseline.
    """
    machines.get(session, machine_id)
    rows = baselines.of_machine(session, machine_id, limit=paging.wanted, after=paging.after)
    return [rendering.baseline(row) for row in paging.page(rows, lambda row: (row.since, row.id))]


@router.post(
    "/machines/{machine_id}/baselines",
    operation_id="begin_baseline",
    dependencies=[ANALYST],
    status_code=status.HTTP_201_CREATED,
    responses=CHANGES,
)
def begin_baseline(request: Request, machine_id: MachineId, body: schemas.BaselineIn) -> schemas.BaselineOut:
    """Begin a baseline: later measurements are compared with the first runs after a moment, or with named identifications."""
    with database(request).transaction() as session:
        machines.get(session, machine_id)
        row = baseline_changes.begin(
            session,
            machine_id,
            since=instant(body.since),
            reason=body.reason,
            by=body.by,
            identification_ids=body.identifications,
        )
        return rendering.baseline(row)
