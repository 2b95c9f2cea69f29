"""Repository of the processes that work on one database: which are alive, and which are gone.

On PostgreSQL a replica holds an advisory lock under its number on a connection of its own: a killed process loses it at once.
One that hangs, or whose host is cut off, counts as gone when it has sent no heartbeat for LEASE_S. An SQLite file belongs to
one process (`Database.claim`): all other rows there are of earlier processes.
"""

from collections.abc import Sequence

from sqlalchemy import BigInteger, cast, column, delete, func, select, table
from sqlalchemy.orm import Session

from storage.clock import now
from storage.tables.operation import ReplicaRow

LEASE_S = 15.0
"""Time without a heartbeat after which a replica counts as gone."""
LOCK_CLASS = 0x52554E44
"""First key of the replicas' advisory locks; the second is the replica's number."""

_LOCKS = table("pg_locks", column("locktype"), column("classid"), column("objid"), column("database"), column("granted"))
_DATABASES = table("pg_database", column("oid"), column("datname"))


def join(session: Session, *, role: str, host: str, process: int) -> int:
    """Register a new replica; return its number."""
    moment = clock(session)
    row = ReplicaRow(role=role, host=host, process=process, started_at=moment, seen_at=moment)
    session.add(row)
    session.flush()
    return row.id


def heartbeat(session: Session, number: int) -> bool:
    """Store a heartbeat of a replica; return False when it was declared gone meanwhile and has lost its leases."""
    row = session.get(ReplicaRow, number)
    if row is None:
        return False
    row.seen_at = clock(session)
    return True


def list_all(session: Session) -> Sequence[ReplicaRow]:
    """Return all registered replicas, by number."""
    return session.scalars(select(ReplicaRow).order_by(ReplicaRow.id)).all()


def expired(session: Session, *, me: int) -> list[ReplicaRow]:
    """Return the replicas that are not alive any more. me: number of the replica that asks."""
    others = [row for row in list_all(session) if row.id != me]
    if session.get_bind().dialect.name != "postgresql":
        return others
    held, oldest = _lock_holders(session), clock(session) - int(LEASE_S * 1e9)
    # A server that has just started has forgotten all locks: living replicas take theirs again in a moment.
    telling = _started(session) < oldest
    return [row for row in others if (telling and row.id not in held) or row.seen_at < oldest]


def forget(session: Session, number: int) -> None:
    """Delete a replica."""
    session.execute(delete(ReplicaRow).where(ReplicaRow.id == number))


def clock(session: Session) -> int:
    """Return the database's clock [ns]; for an SQLite file this process's own."""
    if session.get_bind().dialect.name != "postgresql":
        return now()
    epoch = func.extract("epoch", func.clock_timestamp())
    return int(session.scalar(select(cast(epoch * 1_000_000, BigInteger))) or 0) * 1_000


def _started(session: Session) -> int:
    epoch = func.extract("epoch", func.pg_postmaster_start_time())
    return int(session.scalar(select(cast(epoch * 1_000_000, BigInteger))) or 0) * 1_000


def _lock_holders(session: Session) -> set[int]:
    here = select(_DATABASES.c.oid).where(_DATABASES.c.datname == func.current_database()).scalar_subquery()
    query = select(_LOCKS.c.objid).where(
        _LOCKS.c.locktype == "advisory", _LOCKS.c.classid == LOCK_CLASS, _LOCKS.c.granted, _LOCKS.c.database == here
    )
    return {int(number) for number in session.scalars(query)}
