"""Repository of API keys: found by their prefix, of which only the hash of the whole is kept. Rows stay for ever."""

from collections.abc import Sequence

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from storage.clock import now
from storage.tables import ApiKeyRow

USE_INTERVAL_NS = 600 * 1_000_000_000
"""When a key was last used is written no more often than this [ns]: reading must not become writing."""


class KeyUnknown(KeyError):
    """No key of that prefix."""


def add(
    session: Session, *, prefix: str, key_hash: str, name: str, role: str, plants: Sequence[str] | None, expires_at: int
) -> ApiKeyRow:
    """A new key. plants: None for all; expires_at: [ns]."""
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
    """The key of a prefix, valid or not."""
    return session.scalars(select(ApiKeyRow).where(ApiKeyRow.prefix == prefix)).one_or_none()


def get(session: Session, prefix: str) -> ApiKeyRow:
    """Raises KeyUnknown."""
    row = find(session, prefix)
    if row is None:
        raise KeyUnknown(prefix)
    return row


def list_all(session: Session) -> Sequence[ApiKeyRow]:
    """All keys, oldest first."""
    return session.scalars(select(ApiKeyRow).order_by(ApiKeyRow.id)).all()


def any_exist(session: Session) -> bool:
    """Whether there ever was a key: one that is revoked or has expired must not leave the door open."""
    return session.scalars(select(ApiKeyRow.id).limit(1)).first() is not None


def awaits_confirmation(row: ApiKeyRow) -> bool:
    """Whether a restore brought a key back of which nobody knows whether it was revoked since.

    Its end has a minus sign then: no release opens anything with it.
    """
    return row.revoked_at is None and row.expires_at < 0


def count_unconfirmed(session: Session) -> int:
    """How many keys wait for a confirmation."""
    query = select(func.count()).select_from(ApiKeyRow).where(ApiKeyRow.revoked_at.is_(None), ApiKeyRow.expires_at < 0)
    return session.scalar(query) or 0


def confirm(row: ApiKeyRow) -> None:
    """Let a key that waits be good again, until it ends."""
    row.expires_at = abs(row.expires_at)


def valid(row: ApiKeyRow, *, at: int) -> bool:
    """Whether a key opens something at a moment [ns]."""
    return row.revoked_at is None and at < row.expires_at


def revoke(row: ApiKeyRow) -> None:
    """It opens nothing more. One that is revoked already stays as it is."""
    if row.revoked_at is None:
        row.revoked_at = now()


def expire_by(row: ApiKeyRow, moment: int) -> None:
    """Let a key expire at a moment [ns] if it would not anyway."""
    row.expires_at = min(row.expires_at, moment)


def note_use(session: Session, prefix: str) -> None:
    """Write down that a key was used now."""
    get(session, prefix).last_used_at = now()


def use_is_stale(row: ApiKeyRow, *, at: int) -> bool:
    """Whether a use at a moment [ns] is worth writing down."""
    return row.last_used_at is None or at - row.last_used_at > USE_INTERVAL_NS
