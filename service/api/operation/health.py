"""Serves the health and readiness of the service itself, its sources and its quarantine."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, cast

from fastapi import APIRouter, Query, Request, Response, status
from sqlalchemy.exc import DBAPIError

from formats.wire import InternalErrorReason, Reason
from rotorundown.environment.release import VERSION
from service.api.conventions.dependencies import Reading, database, moment, principal
from service.api.conventions.paging import ById, BySource
from service.api.conventions.times import Time
from service.api.operation import rendering, schemas
from service.security.requirement import ADMIN, ANYBODY, VIEWER
from service.security.role import Role
from storage.database.claim import DatabaseUnusable, without_folder
from storage.database.engine import Database
from storage.database.errors import is_database_wide
from storage.measurements import quarantine, samples

router = APIRouter(tags=["operations"])

Parts = Callable[[], dict[str, str]]
ENDED = "its thread has ended"
"""Status of a part that will not work again in this process."""

NOT_OF_SAMPLES = frozenset({"database", "mqtt_alerts", "mqtt_samples", "opcua"})
"""Parts whose trouble does not say that samples cannot be taken."""


@dataclass(frozen=True)
class HealthReport:
    """State of each part (`ok` or the fault), of the database too, and the jobs of all plants by state.

    answers: whether the database answers. A partly damaged one does, and samples of other machines are still taken.
    """

    parts: dict[str, str]
    jobs: dict[str, int]
    answers: bool


async def health_report(request: Request) -> HealthReport:
    """Check the parts and the database now."""
    kept = cast(Database, request.app.state.database)
    parts: dict[str, str] = request.app.state.parts()
    if (trouble := request.app.state.broadcaster.trouble) is not None:
        parts = parts | {"alert_events": trouble}
    counts: dict[str, int] = {}
    unanswered: str | None = None
    try:
        counts = await request.app.state.database_check.jobs()
    except DatabaseUnusable as error:
        unanswered = str(error)
    except DBAPIError as error:
        if is_database_wide(error):
            unanswered = f"the database does not answer: {error.orig}"
    parts["database"] = unanswered or kept.damage.trouble or "ok"
    return HealthReport(parts, counts, answers=unanswered is None)


async def _health(request: Request) -> schemas.Health:
    look = await health_report(request)
    parts = look.parts
    kept = cast(Database, request.app.state.database)
    # A stream without a peer is waiting, not broken.
    healthy = all(state == "ok" for name, state in parts.items() if name != "stream")
    # Of a store that is damaged in parts, what concerns other machines is taken.
    ready = look.answers and all(state == "ok" for name, state in parts.items() if name not in NOT_OF_SAMPLES)
    whole = schemas.Health(
        healthy=healthy,
        ready=ready,
        version=VERSION,
        parts=parts,
        database=kept.version,
        warnings=[*kept.objections, *request.app.state.warnings()],
        jobs=look.jobs,
    )
    who = principal(request)
    if who.kind != "anonymous" and who.plants is None:
        return whole if who.role is Role.ADMIN else _without_folder(whole, kept)
    # What ails it may name machines and files: who is not known is told that much and no more.
    outline = {name: "ok" if state == "ok" else "not ok" for name, state in parts.items()}
    return whole.model_copy(
        update={"parts": outline, "jobs": {}, "database": "", "warnings": []} | ({} if who.known else {"version": ""})
    )


def _without_folder(whole: schemas.Health, kept: Database) -> schemas.Health:
    """Return the report for callers who do not administer the service: its faults, without the places of its files."""
    parts = {name: without_folder(kept.engine, state) for name, state in whole.parts.items()}
    return whole.model_copy(update={"parts": parts, "warnings": [without_folder(kept.engine, one) for one in whole.warnings]})


@router.get("/health", operation_id="read_health", dependencies=[ANYBODY], responses={503: {"model": schemas.Health}})
async def read_health(request: Request, response: Response) -> schemas.Health:
    """Check every part; answers 503 when one does not work."""
    health = await _health(request)
    if not health.healthy:
        response.status_code = status.HTTP_503_SERVICE_UNAVAILABLE
    return health


@router.get("/ready", operation_id="read_readiness", dependencies=[ANYBODY], responses={503: {"model": schemas.Health}})
async def read_readiness(request: Request, response: Response) -> schemas.Health:
    """Check whether samples can be taken now; answers 503 when not, for instance while no zenoh router answers."""
    health = await _health(request)
    if not health.ready:
        response.status_code = status.HTTP_503_SERVICE_UNAVAILABLE
    return health


@router.get("/alive", operation_id="read_life", dependencies=[ANYBODY], responses={503: {"model": schemas.Life}})
async def read_life(request: Request, response: Response) -> schemas.Life:
    """Check whether the process needs a restart: 503 when a thread has ended, or its SQLite file was deleted and all data are
    saved.

    It depends on nothing outside: a process that only waits for its database or its router is not restarted.
    """
    parts: dict[str, str] = request.app.state.parts()
    kept = cast(Database, request.app.state.database)
    alive = ENDED not in parts.values() and not kept.needs_restart
    if not alive:
        response.status_code = status.HTTP_503_SERVICE_UNAVAILABLE
    return schemas.Life(alive=alive)


@router.get("/sources", operation_id="list_sources", dependencies=[VIEWER])
def list_sources(session: Reading, paging: BySource) -> list[schemas.SourceOut]:
    """List every known source: how far it was received, duplicates, losses."""
    rows = samples.sources(session, limit=paging.wanted, after=paging.after)
    return [rendering.source(row) for row in paging.page(rows, lambda row: (row.machine_id, row.source, row.epoch))]


WhichReason = Annotated[Reason | InternalErrorReason | None, Query(description="only entries with this reason")]


@router.get("/quarantine", operation_id="read_quarantine", dependencies=[VIEWER])
def read_quarantine(
    session: Reading, paging: ById, reason: WhichReason = None, machine: Annotated[str | None, Query()] = None
) -> schemas.Quarantine:
    """Read rejected input: total counts by reason, and the newest entries that are still kept."""
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
    """Delete entries for good. The counts stay."""
    with database(request).transaction() as session:
        return schemas.Purged(deleted=quarantine.purge(session, before=moment(before), reason=reason))
