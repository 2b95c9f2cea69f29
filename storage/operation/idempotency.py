"""Repository of idempotency keys: what a client already asked for under a key of its own, and what it was answered."""

from dataclasses import dataclass

from sqlalchemy import delete, select
from sqlalchemy.orm import Session

from storage.clock import now
from storage.tables import IdempotencyKeyRow

RETENTION_NS = 24 * 3600 * 1_000_000_000
"""A key is known for a day [ns]."""


@dataclass(frozen=True)
class StoredResponse:
    """What was answered. headers: those that belong to the answer itself."""

    status: int
    headers: list[list[str]]
    body: bytes


def claim(session: Session, key: str, fingerprint: str) -> IdempotencyKeyRow | None:
    """Take a key; where it was taken before, its row, and nothing is changed. Keys older than a day are forgotten."""
    moment = now()
    session.execute(delete(IdempotencyKeyRow).where(IdempotencyKeyRow.created_at < moment - RETENTION_NS))
    row = session.get(IdempotencyKeyRow, key)
    if row is None:
        session.add(IdempotencyKeyRow(key=key, fingerprint=fingerprint, created_at=moment))
    return row


def store_response(session: Session, key: str, answer: StoredResponse) -> None:
    """Keep what was answered under a key that was taken."""
    row = session.get_one(IdempotencyKeyRow, key)
    row.status, row.headers, row.body = answer.status, answer.headers, answer.body


def release(session: Session, key: str) -> None:
    """Forget a key: nothing was changed under it."""
    session.execute(delete(IdempotencyKeyRow).where(IdempotencyKeyRow.key == key))


def forget_answers_with(session: Session, text: bytes) -> int:
    """Forget the keys whose answers hold a text; returns how many there were."""
    held = select(IdempotencyKeyRow.key, IdempotencyKeyRow.body).where(IdempotencyKeyRow.body.is_not(None))
    found = [key for key, body in session.execute(held) if body is not None and text in body]
    for key in found:
        release(session, key)
    return len(found)
