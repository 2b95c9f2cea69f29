"""Repository of leases: each part of the work is done by one replica at a time.

Whoever writes under a lease calls `require` in the same transaction: a takeover then waits for that transaction, or the
transaction fails, so that two replicas never both write.
"""

from collections.abc import Collection, Sequence

from sqlalchemy import select, update
from sqlalchemy.orm import Session

from storage.database.errors import LeaseLost
from storage.operation.replicas import clock
from storage.tables.operation import LeaseRow


def ensure(session: Session, names: Collection[str]) -> None:
    """Create free leases for those of these names that have none."""
    known = set(session.scalars(select(LeaseRow.name).where(LeaseRow.name.in_(names))))
    session.add_all(LeaseRow(name=name, holder=None, since=clock(session)) for name in sorted(set(names) - known))


def held(session: Session, *, holder: int) -> set[str]:
    """Return the leases of a replica."""
    return set(session.scalars(select(LeaseRow.name).where(LeaseRow.holder == holder)))


def holders(session: Session) -> dict[str, int | None]:
    """Return the holder of each lease; None for a free one."""
    return {row.name: row.holder for row in session.execute(select(LeaseRow.name, LeaseRow.holder).order_by(LeaseRow.name))}


def acquire(session: Session, names: Sequence[str], *, holder: int, most: int) -> set[str]:
    """Take at most `most` of these leases that are free; never waits for another replica."""
    query = select(LeaseRow).where(LeaseRow.name.in_(names), LeaseRow.holder.is_(None)).order_by(LeaseRow.name)
    moment, taken = clock(session), set()
    for row in session.scalars(query.limit(most).with_for_update(skip_locked=True)):
        row.holder, row.since = holder, moment
        taken.add(row.name)
    return taken


def release(session: Session, names: Collection[str], *, holder: int) -> None:
    """Release these leases; waits for transactions that write under them."""
    session.execute(update(LeaseRow).where(LeaseRow.name.in_(names), LeaseRow.holder == holder).values(holder=None))


def release_all(session: Session, *, holder: int) -> None:
    """Release all leases of a replica that is gone."""
    session.execute(update(LeaseRow).where(LeaseRow.holder == holder).values(holder=None))


def require(session: Session, names: Collection[str], *, holder: int) -> None:
    """Raise LeaseLost unless all these leases are the replica's; they stay so until this transaction ends."""
    query = select(LeaseRow.name).where(LeaseRow.name.in_(names), LeaseRow.holder == holder).with_for_update(read=True)
    missing = set(names) - set(session.scalars(query))
    if missing:
        raise LeaseLost(missing)
