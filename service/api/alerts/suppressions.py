"""Serves suppressions: machines, probes and rules whose alerts notify nobody for a while."""

from fastapi import APIRouter, Request, Response, status

from service.alerts import transitions
from service.alerts.lifecycle import Forbidden, Suppression
from service.alerts.transitions import Person
from service.api.alerts import rendering, schemas
from service.api.conventions.dependencies import MachineId, Number, Reading, database, instant
from service.api.conventions.paging import ById
from service.api.conventions.preconditions import IfMatch, require, tagged
from service.api.conventions.problems import CHANGES, RESPONSES
from service.monitoring.rules.suppression_scope import require_possible
from service.security.requirement import OPERATOR, VIEWER
from storage.alerts import alerts, suppressions
from storage.clock import now
from storage.machines import machines

MOST_ALERTS = 1000
"""Most open alerts whose rule and element may be suppressed though the machine's document no longer has them."""
router = APIRouter(tags=["alerts"], responses=RESPONSES, dependencies=[VIEWER])


@router.get("/machines/{machine_id}/suppressions", operation_id="list_suppressions")
def list_suppressions(session: Reading, machine_id: MachineId, paging: ById) -> list[schemas.SuppressionOut]:
    """List the suppressions in force on a machine, including shelvings."""
    machines.get(session, machine_id)
    rows = suppressions.in_force(session, machine_id, limit=paging.wanted, after=paging.after)
    return [rendering.suppression(row) for row in paging.page(rows, lambda row: (row.id,))]


@router.post(
    "/machines/{machine_id}/suppressions",
    operation_id="begin_suppression",
    dependencies=[OPERATOR],
    status_code=status.HTTP_201_CREATED,
    responses=CHANGES,
)
def begin_suppression(
    request: Request, response: Response, machine_id: MachineId, body: schemas.SuppressionIn
) -> schemas.SuppressionOut:
    """Suppress open and new alerts of a machine in maintenance or a probe out of service, until the suppression ends."""
    until = None if body.until is None else instant(body.until)
    if until is not None and until <= now():
        raise Forbidden("until must be a moment to come")
    with database(request).reading() as session:  # a document is long, and other writers wait for a transaction
        document = machines.document(session, machine_id)
        standing = alerts.find(session, machine_id=machine_id, only_open=True, limit=MOST_ALERTS)
        require_possible(document, body.rule, body.element, of_alerts=[(one.rule, one.element) for one in standing])
    with database(request).transaction() as session:
        machines.get(session, machine_id)
        row = transitions.suppress(
            session,
            machine_id,
            Suppression(body.kind),
            Person(body.by, body.comment),
            rule=body.rule,
            element=body.element,
            until=until,
        )
        return tagged(response, rendering.suppression(row))


@router.get("/suppressions/{suppression_id}", operation_id="read_suppression")
def read_suppression(session: Reading, response: Response, suppression_id: Number) -> schemas.SuppressionOut:
    """Read one suppression, in force or ended, and the ETag that ending it needs."""
    return tagged(response, rendering.suppression(suppressions.get(session, suppression_id)))


@router.post("/suppressions/{suppression_id}/end", operation_id="end_suppression", dependencies=[OPERATOR], responses=CHANGES)
def end_suppression(
    request: Request, response: Response, suppression_id: Number, body: schemas.By, if_match: IfMatch = None
) -> schemas.SuppressionOut:
    """End a suppression: alerts whose cause persists notify again."""
    with database(request).transaction() as session:
        row = suppressions.get(session, suppression_id)
        require(if_match, rendering.suppression(row))
        transitions.release(session, row, Person(body.by, body.comment))
        return tagged(response, rendering.suppression(row))
