"""Machines and the revisions of their documents."""

from dataclasses import replace
from typing import Annotated

from fastapi import APIRouter, Body, Request, Response, status
from sqlalchemy.orm import Session

from estimator.errors import NotAllowed
from estimator.machine.checks.document_size import require_acceptable
from estimator.machine.document import DocumentError, Machine
from service.api.cache.response_cache import Cached
from service.api.conventions.dependencies import MachineId, Reading, database, principal
from service.api.conventions.many_problems import LISTING_FEW_PROBLEMS
from service.api.conventions.paging import ById, ByName
from service.api.conventions.preconditions import IfMatch, require, tagged
from service.api.conventions.problems import RESPONSES
from service.api.machines import rendering, schemas
from service.api.machines.machine_list import MachineList
from service.http.problem import Problem
from service.monitoring import baseline_changes
from service.security.requirement import ADMIN, VIEWER
from storage.machines import machines

router = APIRouter(prefix="/machines", tags=["machines"], responses=RESPONSES, dependencies=[VIEWER])

LARGEST_PAGE = 4 * 2**20
"""Most characters of the documents in an answer: some take a megabyte, and there may be a thousand revisions."""
WholeDocument = Annotated[Machine, LISTING_FEW_PROBLEMS, Body(description="the whole machine document")]


@router.get("", operation_id="list_machines", response_model=list[schemas.MachineSummary])
async def list_machines(request: Request, cache: Cached, paging: ByName) -> Response:
    """List all machines, by id."""
    known: MachineList = request.app.state.machine_list

    def read() -> Response:
        with database(request).reading() as session:
            rows = known.page(session, limit=paging.wanted, after=paging.after)
        return paging.json([rendering.listed_machine(one) for one in paging.page(rows, lambda one: (one.id,))])

    return await cache.answer(request, ("machines", "machine_revisions"), read)


@router.post(
    "",
    operation_id="create_machine",
    dependencies=[ADMIN],
    status_code=status.HTTP_201_CREATED,
    responses={409: {"model": Problem}},
)
def create_machine(request: Request, response: Response, document: WholeDocument) -> schemas.MachineRevision:
    """Create a machine from its document. Its sources may publish from now on."""
    require_acceptable(document)
    who = principal(request)
    if not who.sees(document.plant):
        raise NotAllowed(f"plant '{document.plant}' is not one of those of {who.name}")
    with database(request).transaction() as session:
        row = machines.create(session, document)
    response.headers["Location"] = f"/api/v1/machines/{document.id}"
    return tagged(response, rendering.revision(row))


@router.get("/{machine_id}", operation_id="read_machine")
def read_machine(session: Reading, response: Response, machine_id: MachineId) -> schemas.MachineRevision:
    """Read the machine's document in force, with the ETag that a revision needs."""
    return tagged(response, _in_force(session, machine_id))


@router.put("/{machine_id}", operation_id="revise_machine", dependencies=[ADMIN], responses={409: {"model": Problem}})
def revise_machine(
    request: Request, response: Response, machine_id: MachineId, document: WholeDocument, if_match: IfMatch = None
) -> schemas.MachineRevision:
    """Put a new revision of the document in force. Runs and identifications keep the revision that they were made with."""
    if document.id != machine_id:
        raise DocumentError([("id", f"'{document.id}' must be '{machine_id}', the machine that is revised")])
    require_acceptable(document)
    with database(request).transaction() as session:
        require(if_match, _in_force(session, machine_id))
        row = baseline_changes.revise(session, document)
    return tagged(response, rendering.revision(row))


def _in_force(session: Session, machine_id: str) -> schemas.MachineRevision:
    return rendering.revision(machines.revision(session, machine_id, machines.get(session, machine_id).revision))


@router.get("/{machine_id}/revisions", operation_id="list_revisions")
def list_revisions(session: Reading, machine_id: MachineId, paging: ById) -> list[schemas.MachineRevision]:
    """List all revisions of the document, oldest first; of large documents fewer at a time than `limit`: follow the Link."""
    machines.get(session, machine_id)
    count = machines.count_within(session, machine_id, limit=paging.limit, after=paging.after, size=LARGEST_PAGE)
    paging = replace(paging, limit=count)
    rows = machines.revisions(session, machine_id, limit=paging.wanted, after=paging.after)
    return [rendering.revision(row) for row in paging.page(rows, lambda row: (row.revision,))]
