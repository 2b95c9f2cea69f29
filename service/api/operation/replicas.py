"""`GET /replicas`: the processes that work on this database, with their leases."""

from collections import defaultdict
from datetime import datetime
from typing import cast

from fastapi import APIRouter
from pydantic import BaseModel, Field

from service.api.conventions.dependencies import Reading
from service.configuration.settings import ProcessRole
from service.replication.work_share import INGEST
from service.security.requirement import ADMIN_OF_ALL
from storage.clock import to_datetime
from storage.operation import leases, replicas

router = APIRouter(tags=["operations"], dependencies=[ADMIN_OF_ALL])


class ReplicaOut(BaseModel):
    """A process of the service."""

    id: int = Field(description="its number, which no other replica gets")
    role: ProcessRole
    host: str
    process: int = Field(description="process id on its host")
    started_at: datetime
    seen_at: datetime = Field(description="when it last said that it lives; by the database's clock")
    machine_shares: int = Field(description=f"how many of the {len(INGEST)} parts of the machines it stores")
    leases: list[str] = Field(description="these parts, and what it alone does for all")


@router.get("/replicas", operation_id="list_replicas")
def list_replicas(session: Reading) -> list[ReplicaOut]:
    """List the processes that work on this database, by number. A killed one stays listed until another process notices."""
    held = defaultdict(list)
    for name, holder in leases.holders(session).items():
        held[holder].append(name)
    return [
        ReplicaOut(
            id=row.id,
            role=cast(ProcessRole, row.role),
            host=row.host,
            process=row.process,
            started_at=to_datetime(row.started_at),
            seen_at=to_datetime(row.seen_at),
            machine_shares=len(set(held[row.id]) & set(INGEST)),
            leases=held[row.id],
        )
        for row in replicas.list_all(session)
    ]
