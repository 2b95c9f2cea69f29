"""Repository of logins in progress at an issuer: the state needed when the browser returns, to whichever replica."""

from sqlalchemy import delete, select
from sqlalchemy.orm import Session

from storage.clock import now
from storage.tables.operation import LoginRow

MOST = 1000
"""Largest number of logins in progress, since anybody may begin one; beyond it the oldest are deleted."""


def begin(session: Session, *, state_hash: str, browser_hash: str, verifier: str, nonce: str, expires_at: int) -> None:
    """Store a login in progress; delete those that have expired."""
    session.execute(delete(LoginRow).where(LoginRow.expires_at <= now()))
    kept = select(LoginRow.state_hash).order_by(LoginRow.expires_at.desc()).limit(MOST - 1)
    session.execute(delete(LoginRow).where(LoginRow.state_hash.not_in(kept.scalar_subquery())))
    session.add(
        LoginRow(state_hash=state_hash, browser_hash=browser_hash, verifier=verifier, nonce=nonce, expires_at=expires_at)
    )


def pop(session: Session, state_hash: str, *, at: int) -> LoginRow | None:
    """Return a login that is valid at a time [ns], and delete it: it works once."""
    row = session.scalars(select(LoginRow).where(LoginRow.state_hash == state_hash).with_for_update()).one_or_none()
    if row is None:
        return None
    session.delete(row)
    return row if at < row.expires_at else None
