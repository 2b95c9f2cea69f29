"""Machines, probes and rules whose alerts call nobody for a while, and notes on machines' timelines."""

from fastapi import APIRouter, Request, status

from service import alerting, baselining
from service.alert_life import Forbidden, Suppression
from service.alerting import Person
from service.api import alert_rendering as rendering
from service.api import alert_schemas as schemas
from service.api.access import MachineId, Number, Period, Reading, database, instant
from service.api.paging import ById, ByTime
from service.api.problems import CHANGES, RESPONSES
from storage import machines, suppressions, timeline
from storage.clock import now

router = APIRouter(tags=["alerts"], responses=RESPONSES)


@router.get("/machines/{machine_id}/suppressions", operation_id="list_suppressions")
def list_suppressions(session: Reading, machine_id: MachineId, paging: ById) -> list[schemas.SuppressionOut]:
    """What is suppressed on a machine now, shelvings among it."""
    machines.get(session, machine_id)
    rows = suppressions.in_force(session, machine_id, limit=paging.wanted, after=paging.after)
    return [rendering.suppression(row) for row in paging.page(rows, lambda row: (row.id,))]


@router.post(
    "/machines/{machine_id}/suppressions",
    operation_id="begin_suppression",
    status_code=status.HTTP_201_CREATED,
    responses=CHANGES,
)
def begin_suppression(request: Request, machine_id: MachineId, said: schemas.SuppressionIn) -> schemas.SuppressionOut:
    """A machine in maintenance, a probe out of service: alerts open and to come call nobody until it is ended."""
    until = None if said.until is None else instant(said.until)
    if until is not None and until <= now():
        raise Forbidden("until must be a moment to come")
    with database(request).transaction() as session:
        machines.get(session, machine_id)
        row = alerting.suppress(
            session,
            machine_id,
            Suppression(said.kind),
            Person(said.by, said.comment),
            rule=said.rule,
            element=said.element,
            until=until,
        )
        return rendering.suppression(row)


@router.post("/suppressions/{suppression_id}/end", operation_id="end_suppression", responses=CHANGES)
def end_suppression(request: Request, suppression_id: Number, said: schemas.By) -> schemas.SuppressionOut:
    """Alerts whose cause is there call again."""
    with database(request).transaction() as session:
        row = suppressions.get(session, suppression_id)
        alerting.release(session, row, Person(said.by, said.comment))
        return rendering.suppression(row)


@router.get("/machines/{machine_id}/timeline", operation_id="read_timeline")
def read_timeline(session: Reading, machine_id: MachineId, period: Period, paging: ByTime) -> list[schemas.TimelineOut]:
    """Notes and markers of a machine, newest first."""
    machines.get(session, machine_id)
    rows = timeline.of_machine(
        session, machine_id, first=period.first, last=period.last, limit=paging.wanted, after=paging.after
    )
    return [rendering.timeline_entry(row) for row in paging.page(rows, lambda row: (row.at, row.id))]


@router.post("/machines/{machine_id}/timeline", operation_id="add_timeline_entry", status_code=status.HTTP_201_CREATED)
def add_timeline_entry(request: Request, machine_id: MachineId, said: schemas.TimelineIn) -> schemas.TimelineOut:
    """Put a note, a marker or a maintenance on a machine's timeline; a maintenance begins a new baseline."""
    with database(request).transaction() as session:
        machines.get(session, machine_id)
        row = baselining.note(session, machine_id, at=instant(said.at), kind=said.kind, text=said.text, by=said.by)
        return rendering.timeline_entry(row)
