"""Repository of the audit trail: append-only, each entry bound to the one before by a hash.

Who can write to the database file can forge the whole chain from some entry on; the newest number and hash, noted elsewhere,
show that too (`verify`, known).
"""

import hashlib
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from sqlalchemy import select, text
from sqlalchemy.orm import Session

from storage.clock import now
from storage.paging import Keys, ordered
from storage.plain_text import nul_back, plain_text
from storage.tables import AuditHeadRow, AuditRow

BEGINNING = "0" * 64
"""What the first entry is bound to."""
HEAD = 1
LOCK = 0x525541554449
"""Number of PostgreSQL's advisory lock: one writer at a time, or two entries would follow the same one."""


@dataclass(frozen=True)
class Entry:
    """What happened. who: principal; operation: what was asked; target: on what; outcome: what became of it."""

    who: str
    address: str
    operation: str
    target: str
    outcome: str


@dataclass(frozen=True)
class Break:
    """Where the chain does not hold, and why."""

    number: int
    reason: str


def append(session: Session, entry: Entry) -> AuditRow:
    """Write an entry, in the transaction of what it tells of."""
    if session.get_bind().dialect.name == "postgresql":
        session.execute(text("SELECT pg_advisory_xact_lock(:number)"), {"number": LOCK})
    head = session.get(AuditHeadRow, HEAD)
    if head is None:
        head = AuditHeadRow(id=HEAD, number=0, hash=BEGINNING)
        session.add(head)
    row = AuditRow(
        number=head.number + 1,
        at=now(),
        who=plain_text(entry.who)[:200],
        address=plain_text(entry.address)[:64],
        operation=plain_text(entry.operation)[:80],
        target=plain_text(entry.target)[:2000],
        outcome=plain_text(entry.outcome)[:80],
        previous=head.hash,
    )
    row.hash = digest(row)
    head.number, head.hash = row.number, row.hash
    session.add(row)
    session.flush()
    return row


def digest(row: AuditRow, *, text_as: Callable[[str], str] = str) -> str:
    """SHA-256 of an entry and the hash before it. text_as: what its texts are taken as."""
    texts = [text_as(one) for one in (row.who, row.address, row.operation, row.target, row.outcome)]
    said = [row.previous, row.number, row.at, *texts]
    return hashlib.sha256(json.dumps(said, ensure_ascii=False, separators=(",", ":")).encode()).hexdigest()


def newest(session: Session, *, limit: int, after: Keys | None = None) -> Sequence[AuditRow]:
    """Entries, newest first; after: number of the one before."""
    return session.scalars(ordered(select(AuditRow), (AuditRow.number,), after).limit(limit)).all()


def head(session: Session) -> tuple[int, str]:
    """Number and hash of the newest entry."""
    row = session.get(AuditHeadRow, HEAD)
    return (0, BEGINNING) if row is None else (row.number, row.hash)


def verify(session: Session, *, known: tuple[int, str] | None = None) -> list[Break]:
    """Every place where an entry was changed, taken away, put in or moved. known: a number and hash noted before."""
    found = []
    number, previous = 0, BEGINNING
    last_number, last_hash = head(session)
    for row in session.scalars(select(AuditRow).order_by(AuditRow.number).execution_options(yield_per=1000)):
        if row.number != number + 1:
            found.append(Break(number + 1, f"missing: the entry behind {number} is {row.number}"))
        elif row.previous != previous:
            found.append(Break(row.number, "does not follow the entry before it"))
        # An entry of an older release may hold NUL, which a move to PostgreSQL has escaped.
        if row.hash != digest(row) and row.hash != digest(row, text_as=nul_back):
            found.append(Break(row.number, "was changed"))
        if known is not None and row.number == known[0] and row.hash != known[1]:
            found.append(Break(row.number, "is not the entry that was noted"))
        number, previous = row.number, row.hash
    if (number, previous) != (last_number, last_hash):
        found.append(Break(last_number, f"the last entry should be {last_number}, and is {number}"))
    if known is not None and number < known[0]:
        found.append(Break(known[0], f"was noted, and there are only {number}"))
    return found
