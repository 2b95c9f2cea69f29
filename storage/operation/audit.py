"""Repository of the audit trail: append-only, each entry chained to the one before by a hash.

Whoever can write to the database file can forge the whole chain from some entry on; the newest number and hash, recorded
elsewhere, reveal that too (`verify`, known).
"""

import hashlib
import json
import re
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from sqlalchemy import select, text
from sqlalchemy.orm import Session

from storage.clock import now
from storage.encoding.text import nul_unescaped, plain_text
from storage.paging import Keys, ordered
from storage.tables.operation import AuditHeadRow, AuditRow

BEGINNING = "0" * 64
"""The hash that the first entry is chained to."""
HEAD = 1
SURROGATES = re.compile("[\ud800-\udfff]")
"""Characters that are read in place of bytes that are not UTF-8."""
LOCK = 0x525541554449
"""Key of PostgreSQL's advisory lock for one writer at a time: otherwise two entries could follow the same one."""


@dataclass(frozen=True)
class AuditedOperation:
    """An audited operation. who: principal; operation: what was requested; target: its object; outcome: its result."""

    who: str
    address: str
    operation: str
    target: str
    outcome: str


@dataclass(frozen=True)
class Break:
    """A place where the chain is broken, and why."""

    number: int
    reason: str


def append(session: Session, entry: AuditedOperation) -> AuditRow:
    """Append an entry, within the transaction of the operation it records."""
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
    session.add(row)
    session.flush()  # the database lets the head follow only an entry that is there
    head.number, head.hash = row.number, row.hash
    session.flush()
    return row


def digest(row: AuditRow, *, text_as: Callable[[str], str] = str) -> str:
    """Return the SHA-256 of an entry and the hash before it. text_as: conversion of its texts."""
    texts = [text_as(one) for one in (row.who, row.address, row.operation, row.target, row.outcome)]
    said = [row.previous, row.number, row.at, *texts]
    return hashlib.sha256(json.dumps(said, ensure_ascii=False, separators=(",", ":")).encode()).hexdigest()


def newest(session: Session, *, limit: int, after: Keys | None = None) -> Sequence[AuditRow]:
    """Return the entries, newest first. after: number of the last one of the page before."""
    return session.scalars(ordered(select(AuditRow), (AuditRow.number,), after).limit(limit)).all()


def head(session: Session) -> tuple[int, str]:
    """Return number and hash of the newest entry."""
    row = session.get(AuditHeadRow, HEAD)
    return (0, BEGINNING) if row is None else (row.number, row.hash)


def is_intact(session: Session, entry: tuple[int, str]) -> bool:
    """Return whether the entry with a number and hash recorded before still exists unchanged."""
    number, digest = entry
    if number == 0:
        return True
    row = session.get(AuditRow, number)
    return row is not None and row.hash == digest and head(session)[0] >= number


def verify(session: Session, *, known: Collection[tuple[int, str]] = ()) -> list[Break]:
    """Return every place where an entry was changed, removed, inserted or moved. known: numbers and hashes recorded before."""
    with _undecoded_text(session):
        return list(_breaks(session, known))


def _breaks(session: Session, known: Collection[tuple[int, str]]) -> Iterator[Break]:
    noted: dict[int, set[str]] = {}
    for number, hashed in known:
        noted.setdefault(number, set()).add(hashed)
    number, previous = 0, BEGINNING
    last_number, last_hash = head(session)
    for row in session.scalars(select(AuditRow).order_by(AuditRow.number).execution_options(yield_per=1000)):
        yield from _breaks_at(row, number, previous)
        if noted.get(row.number, set()) - {row.hash}:
            yield Break(row.number, "is not the entry that was noted")
        number, previous = row.number, row.hash
    if number != last_number:
        yield Break(last_number, f"the last entry should be {last_number}, and is {number}")
    elif previous != last_hash:
        yield Break(last_number, "is not the last entry that the trail's head names")
    for one in sorted(noted):
        if one > number:
            yield Break(one, f"was noted, and there are only {number}")


def _breaks_at(row: AuditRow, number: int, previous: str) -> Iterator[Break]:
    """Find what is wrong with an entry. number, previous: number and hash of the entry before it."""
    wrong = _of_another_kind(row)
    if row.number != number + 1:
        yield Break(number + 1, f"missing: the entry behind {number} is {row.number}")
    elif row.previous != previous and wrong is None:
        yield Break(row.number, "does not follow the entry before it")
    # An entry of an older release may hold NUL, which a move to PostgreSQL has escaped.
    if wrong is not None:
        yield Break(row.number, f"was changed: its `{wrong[0]}` is no {wrong[1]}")
    elif row.hash != digest(row) and row.hash != digest(row, text_as=nul_unescaped):
        yield Break(row.number, "was changed")


def _of_another_kind(row: AuditRow) -> tuple[str, str] | None:
    """Return the first column with a value of a wrong type, and the right type: SQLite accepts any; None when all are
    right."""
    if not isinstance(row.at, int):
        return "at", "number"
    for name in ("who", "address", "operation", "target", "outcome", "previous", "hash"):
        if not _is_text(getattr(row, name)):
            return name, "text"
    return None


def _is_text(value: object) -> bool:
    return isinstance(value, str) and not SURROGATES.search(value)


@contextmanager
def _undecoded_text(session: Session) -> Iterator[None]:
    """Read texts that are not UTF-8 as well, so that their place can be reported."""
    connection = session.connection()
    driver: Any = connection.connection.driver_connection
    if connection.dialect.name != "sqlite":
        yield
        return
    before = driver.text_factory
    driver.text_factory = lambda raw: raw.decode("utf-8", "surrogateescape")
    try:
        yield
    finally:
        driver.text_factory = before
