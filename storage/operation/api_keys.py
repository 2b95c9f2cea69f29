"""Repository of API keys: each is found by its prefix, and only a hash of the whole key is stored. Rows are never deleted."""

from collections.abc import Sequence

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from estimator.errors import Missing
from storage.clock import now
from storage.tables.operation import ApiKeyRow

USE_INTERVAL_NS = 600 * 1_000_000_000
"""Shortest interval at which the last use of a key is stored [ns]: reading must not become writing."""


class KeyUnknown(Missing):
    """Raised when no key has this prefix."""

    subject = "key"


def add(
    session: Session, *, prefix: str, key_hash: str, name: str, role: str, plants: Sequence[str] | None, expires_at: int
) -> ApiKeyRow:
    """Add a key. plants: None for all; expires_at: [ns]."""
    row = ApiKeyRow(
        prefix=prefix,
        hash=key_hash,
        name=name,
        role=role,
        plants=None if plants is None else sorted(set(plants)),
        created_at=now(),
        expires_at=expires_at,
    )
    session.add(row)
    session.flush()
    return row


def find(session: Session, prefix: str) -> ApiKeyRow | None:
    """Return the key of a prefix, valid or not; None when there is none."""
    return session.scalars(select(ApiKeyRow).where(ApiKeyRow.prefix == prefix)).one_or_none()


def get(session: Session, prefix: str) -> ApiKeyRow:
    """Return the key of a prefix; raise KeyUnknown when there is none."""
    row = find(session, prefix)
    if row is None:
        raise KeyUnknown(prefix)
    return row


def list_all(session: Session) -> Sequence[ApiKeyRow]:
    """Return all keys, oldest first."""
    return session.scalars(select(ApiKeyRow).order_by(ApiKeyRow.id)).all()


def any_exist(session: Session) -> bool:
    """Return whether there ever was a key: a revoked or expired key must not leave the service open."""
    return session.scalars(select(ApiKeyRow.id).limit(1)).first() is not None


def awaits_confirmation(row: ApiKeyRow) -> bool:
    """Return whether a restore brought back a key that may have been revoked since.

    Its expiry is negative then, so that no release accepts it.
    """
    return row.revoked_at is None and row.expires_at < 0


def count_unconfirmed(session: Session) -> int:
    """Return how many keys wait for a confirmation."""
    query = select(func.count()).select_from(ApiKeyRow).where(ApiKeyRow.revoked_at.is_(None), ApiKeyRow.expires_at < 0)
    return session.scalar(query) or 0


def confirm(row: ApiKeyRow) -> None:
    """Make a waiting key valid again, until its expiry."""
    row.expires_at = abs(row.expires_at)


def valid(row: ApiKeyRow, *, at: int) -> bool:
    """Return whether a key is valid at a time [ns]."""
    return row.revoked_at is None and at < row.expires_at


def revoke(row: ApiKeyRow) -> None:
    """Revoke a key; one that is revoked already stays as it is."""
    if row.revoked_at is None:
        row.revoked_at = now()


def expire_by(row: ApiKeyRow, moment: int) -> None:
    """Let a key expire at a time [ns], unless it expires earlier."""
    row.expires_at = min(row.expires_at, moment)


def note_use(session: Session, prefix: str) -> None:
    """Store that a key was used now."""
    get(session, prefix).last_used_at = now()


def use_is_stale(row: ApiKeyRow, *, at: int) -> bool:
    """Return whether a use at a time [ns] is to be stored."""
    return row.last_used_at is None or at - row.last_used_at > USE_INTERVAL_NS
