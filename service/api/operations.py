"""How the service itself is doing: health, readiness, sources, quarantine."""

from collections.abc import Callable
from importlib.metadata import version
from typing import Annotated, cast

from fastapi import APIRouter, Query, Request, Response, status

from service.api import rendering, schemas
from service.api.access import Reading, database, moment, principal
from service.api.paging import ById, BySource
from service.api.times import Time
from service.security.requirement import ADMIN, ANYBODY, VIEWER
from service.wire import Reason
from storage import jobs, quarantine, samples
from storage.claim import DatabaseUnusable
from storage.database import Database

router = APIRouter(tags=["operations"])

Parts = Callable[[], dict[str, str]]


def _health(request: Request) -> schemas.Health:
    parts: dict[str, str] = request.app.state.parts()
    counts: dict[str, int] = {}
    kept = cast(Database, request.app.state.database)
    try:
        kept.check()
        parts["database"] = "ok"
        with database(request).reading() as session:
            counts = jobs.count(session)
    except DatabaseUnusable as error:
        parts["database"] = str(error)
    # A stream without a peer is waiting, not broken.
    healthy = all(state == "ok" for name, state in parts.items() if name != "stream")
    ready = healthy and parts.get("stream", "ok") == "ok"
    whole = schemas.Health(
        healthy=healthy,
        ready=ready,
        version=version("rundown"),
        parts=parts,
        database=kept.version,
        warnings=[*kept.objections, *request.app.state.warnings()],
        jobs=counts,
    )
    who = principal(request)
    if who.kind != "anonymous" and who.plants is None:
        return whole
    # What ails it may name machines and files: who is not known is told that much and no more.
    outline = {name: "ok" if state == "ok" else "not ok" for name, state in parts.items()}
    return whole.model_copy(
        update={"parts": outline, "jobs": {}, "database": "", "warnings": []} | ({} if who.known else {"version": ""})
    )


@router.get("/health", operation_id="read_health", dependencies=[ANYBODY], responses={503: {"model": schemas.Health}})
def read_health(request: Request, response: Response) -> schemas.Health:
    """Whether every part works; 503 when one does not."""
    health = _health(request)
    if not health.healthy:
        response.status_code = status.HTTP_503_SERVICE_UNAVAILABLE
    return health


@router.get("/ready", operation_id="read_readiness", dependencies=[ANYBODY], responses={503: {"model": schemas.Health}})
def read_readiness(request: Request, response: Response) -> schemas.Health:
    """Whether samples can be taken now; 503 when not, for instance while no zenoh router answers."""
    health = _health(request)
    if not health.ready:
        response.status_code = status.HTTP_503_SERVICE_UNAVAILABLE
    return health


@router.get("/sources", operation_id="list_sources", dependencies=[VIEWER])
def list_sources(session: Reading, paging: BySource) -> list[schemas.SourceOut]:
    """Every source heard of: how far it was received, what came twice, what is lost."""
    rows = samples.sources(session, limit=paging.wanted, after=paging.after)
    return [rendering.source(row) for row in paging.page(rows, lambda row: (row.machine_id, row.source, row.epoch))]


WhichReason = Annotated[Reason | None, Query(description="only entries with this reason")]


@router.get("/quarantine", operation_id="read_quarantine", dependencies=[VIEWER])
def read_quarantine(
    session: Reading, paging: ById, reason: WhichReason = None, machine: Annotated[str | None, Query()] = None
) -> schemas.Quarantine:
    """Rejected input: counts by reason since ever, and the newest entries that are still kept."""
    rows = quarantine.newest(session, reason=reason, machine_id=machine, limit=paging.wanted, after=paging.after)
    return schemas.Quarantine(
        counts=quarantine.counts(session),
        entries=[rendering.quarantine_entry(row) for row in paging.page(rows, lambda row: (row.id,))],
    )


@router.delete("/quarantine", operation_id="purge_quarantine", dependencies=[ADMIN])
def purge_quarantine(
    request: Request,
    before: Annotated[Time | None, Query(description="only what was received before; RFC 3339, UTC without a zone")] = None,
    reason: WhichReason = None,
) -> schemas.Purged:
    """Delete entries for good. What was counted stays counted."""
    with database(request).transaction() as session:
        return schemas.Purged(deleted=quarantine.purge(session, before=moment(before), reason=reason))
