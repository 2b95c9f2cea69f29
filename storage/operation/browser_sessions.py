"""Repository of browser sessions: who is logged in on the page, and until when."""

from collections.abc import Sequence

from sqlalchemy import delete, select
from sqlalchemy.orm import Session

from storage.clock import now
from storage.tables.operation import BrowserSessionRow

MOST = 50
"""Largest number of sessions of one principal; further logins end the oldest ones."""


def begin(
    session: Session,
    *,
    cookie_hash: str,
    name: str,
    role: str,
    plants: Sequence[str] | None,
    key_prefix: str | None,
    token: str,
    expires_at: int,
) -> BrowserSessionRow:
    """Add a session; delete those that have expired, and the oldest beyond MOST."""
    moment = now()
    session.execute(delete(BrowserSessionRow).where(BrowserSessionRow.expires_at <= moment))
    theirs = (BrowserSessionRow.name == name) & BrowserSessionRow.key_prefix.is_not_distinct_from(key_prefix)
    newest = select(BrowserSessionRow.hash).where(theirs).order_by(BrowserSessionRow.created_at.desc()).limit(MOST - 1)
    session.execute(delete(BrowserSessionRow).where(theirs & BrowserSessionRow.hash.not_in(newest.scalar_subquery())))
    row = BrowserSessionRow(
        hash=cookie_hash,
        name=name,
        role=role,
        plants=None if plants is None else sorted(plants),
        key_prefix=key_prefix,
        token=token,
        created_at=moment,
        expires_at=expires_at,
    )
    session.add(row)
    return row


def find(session: Session, cookie_hash: str, *, at: int) -> BrowserSessionRow | None:
    """Return the session of a cookie; None unless it is valid at a time [ns]."""
    row = session.get(BrowserSessionRow, cookie_hash)
    return row if row is not None and at < row.expires_at else None


def end(session: Session, cookie_hash: str) -> None:
    """Delete the session of a cookie."""
    session.execute(delete(BrowserSessionRow).where(BrowserSessionRow.hash == cookie_hash))
