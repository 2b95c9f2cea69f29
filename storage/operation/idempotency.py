"""Repository of idempotency keys: requests that clients made under a key of their own, and the responses."""

from dataclasses import dataclass

from sqlalchemy import delete, select
from sqlalchemy.orm import Session

from storage.clock import now
from storage.tables.operation import IdempotencyKeyRow

RETENTION_NS = 24 * 3600 * 1_000_000_000
"""Time for which a key is kept [ns]: one day."""


@dataclass(frozen=True)
class StoredResponse:
    """A response to a request. headers: those that belong to the response itself."""

    status: int
    headers: list[list[str]]
    body: bytes


def claim(session: Session, key: str, fingerprint: str) -> IdempotencyKeyRow | None:
    """Store a new key and return None, or return the row of a known one unchanged.

    Keys older than a day are deleted.
    """
    moment = now()
    session.execute(delete(IdempotencyKeyRow).where(IdempotencyKeyRow.created_at < moment - RETENTION_NS))
    row = session.get(IdempotencyKeyRow, key)
    if row is None:
        session.add(IdempotencyKeyRow(key=key, fingerprint=fingerprint, created_at=moment))
    return row


def store_response(session: Session, key: str, answer: StoredResponse) -> None:
    """Store the response to the request of a key."""
    row = session.get_one(IdempotencyKeyRow, key)
    row.status, row.headers, row.body = answer.status, answer.headers, answer.body


def release(session: Session, key: str) -> None:
    """Delete a key under which nothing was changed."""
    session.execute(delete(IdempotencyKeyRow).where(IdempotencyKeyRow.key == key))


def forget_answers_with(session: Session, text: bytes) -> int:
    """Delete the keys whose responses contain a text; return their number."""
    held = select(IdempotencyKeyRow.key, IdempotencyKeyRow.body).where(IdempotencyKeyRow.body.is_not(None))
    found = [key for key, body in session.execute(held) if body is not None and text in body]
    for key in found:
        release(session, key)
    return len(found)
