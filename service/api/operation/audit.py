"""Serves the client's own identity and the audit trail."""

from datetime import datetime

from fastapi import APIRouter, Request
from pydantic import BaseModel, Field

from service.api.conventions.dependencies import Reading, principal
from service.api.conventions.paging import ById
from service.security.requirement import ADMIN_OF_ALL, VIEWER
from storage.clock import to_datetime
from storage.operation import audit

router = APIRouter(tags=["security"])


class Me(BaseModel):
    """The authenticated client."""

    name: str = Field(description="empty where nobody needs to say who they are")
    role: str = Field(description="viewer, analyst, operator or admin")
    plants: list[str] | None = Field(description="null for all")
    kind: str = Field(description="open, where nobody needs to say who they are; else key, token or session")
    token: str | None = Field(description="of a session: what each change must bring along as X-Rundown-Token")


class AuditEntry(BaseModel):
    """One entry of the audit trail."""

    number: int
    at: datetime
    who: str
    address: str = Field(description="from where")
    operation: str
    target: str
    outcome: str
    previous: str = Field(description="hash of the entry before")
    hash: str = Field(description="SHA-256 of this entry and of the hash before")


@router.get("/me", operation_id="read_me", dependencies=[VIEWER])
def read_me(request: Request) -> Me:
    """Return who you are and what you may do."""
    who = principal(request)
    return Me(
        name=who.name,
        role="" if who.role is None else who.role.label,
        plants=None if who.plants is None else sorted(who.plants),
        kind=who.kind,
        token=who.token,
    )


@router.get("/audit", operation_id="list_audit", dependencies=[ADMIN_OF_ALL])
def list_audit(session: Reading, paging: ById) -> list[AuditEntry]:
    """List changes with author, time, address and outcome, newest first. `rundown audit verify` checks the hashes."""
    rows = audit.newest(session, limit=paging.wanted, after=paging.after)
    return [
        AuditEntry(
            number=row.number,
            at=to_datetime(row.at),
            who=row.who,
            address=row.address,
            operation=row.operation,
            target=row.target,
            outcome=row.outcome,
            previous=row.previous,
            hash=row.hash,
        )
        for row in paging.page(rows, lambda row: (row.number,))
    ]
