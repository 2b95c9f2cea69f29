"""Machines, probes and rules whose alerts call nobody for a while, and notes on machines' timelines."""

from typing import Annotated

from fastapi import APIRouter, Query, Request, status

from service import alerting, baselining
from service.alert_life import Forbidden, Suppression
from service.alerting import Person
from service.api import alert_rendering as rendering
from service.api import alert_schemas as schemas
from service.api.access import From, MachineId, Number, Reading, To, database, instant, moment
from service.api.problems import CHANGES, RESPONSES
from storage import machines, suppressions, timeline
from storage.clock import now

router = APIRouter(tags=["alerts"], responses=RESPONSES)


@router.get("/machines/{machine_id}/suppressions", operation_id="list_suppressions")
def list_suppressions(session: Reading, machine_id: MachineId) -> list[schemas.SuppressionOut]:
    """What is suppressed on a machine now, shelvings among it."""
    machines.get(session, machine_id)
    return [rendering.suppression(row) for row in suppressions.in_force(session, machine_id)]


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
def read_timeline(
    session: Reading,
    machine_id: MachineId,
    first: From = None,
    last: To = None,
    limit: Annotated[int, Query(ge=1, le=1000)] = 100,
) -> list[schemas.TimelineOut]:
    """Notes and markers of a machine, newest first."""
    machines.get(session, machine_id)
    rows = timeline.of_machine(session, machine_id, first=moment(first), last=moment(last), limit=limit)
    return [rendering.timeline_entry(row) for row in rows]


@router.post("/machines/{machine_id}/timeline", operation_id="add_timeline_entry", status_code=status.HTTP_201_CREATED)
def add_timeline_entry(request: Request, machine_id: MachineId, said: schemas.TimelineIn) -> schemas.TimelineOut:
    """Put a note, a marker or a maintenance on a machine's timeline; a maintenance begins a new baseline."""
    with database(request).transaction() as session:
        machines.get(session, machine_id)
        row = baselining.note(session, machine_id, at=instant(said.at), kind=said.kind, text=said.text, by=said.by)
        return rendering.timeline_entry(row)
