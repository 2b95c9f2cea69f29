"""Repository of rejected input: the counts are kept for ever, the payloads while there is room."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self, cast

from sqlalchemy import CursorResult, delete, func, select, update
from sqlalchemy.orm import Session

from storage.encoding.text import plain_text
from storage.paging import Keys, ordered
from storage.tables.measurements import QuarantineCountRow, QuarantineRow

KEPT_ROWS = 10_000
KEPT_BYTES = 4096


@dataclass(frozen=True)
class Rejection:
    """A rejected message or sample, with the reason and what would have been right.

    count: number of rejections it represents; size: size of the whole payload [bytes], when `payload` is only a part of it.
    """

    received_at: int
    key: str
    machine_id: str | None
    reason: str
    detail: str
    payload: bytes
    count: int = 1
    size: int | None = None

    @classmethod
    def of_message(
        cls,
        *,
        received_at: int,
        key: str,
        machine_id: str | None,
        reason: str,
        detail: str,
        payload: bytes,
        size: int | None = None,
    ) -> Self:
        """Return the rejection of a message with its payload cut to what will be kept.

        size: size of the whole payload, when `payload` is a part.
        """
        whole = len(payload) if size is None else size
        return cls(received_at, key, machine_id, reason, detail, payload[:KEPT_BYTES], size=whole)


def add(session: Session, rejections: Sequence[Rejection]) -> None:
    """Store and count rejections; delete the oldest beyond KEPT_ROWS."""
    for one in rejections[-KEPT_ROWS:]:
        session.add(
            QuarantineRow(
                received_at=one.received_at,
                key=plain_text(one.key)[:512],
                machine_id=one.machine_id,
                reason=one.reason,
                detail=plain_text(one.detail)[:2000],
                size=len(one.payload) if one.size is None else one.size,
                payload=one.payload[:KEPT_BYTES],
            )
        )
    for reason in sorted({one.reason for one in rejections}):
        count = sum(one.count for one in rejections if one.reason == reason)
        # Incremented in the database, since other replicas add to it as well.
        adding = update(QuarantineCountRow).where(QuarantineCountRow.reason == reason)
        known = session.execute(adding.values(count=QuarantineCountRow.count + count))
        if cast("CursorResult[Any]", known).rowcount == 0:
            session.add(QuarantineCountRow(reason=reason, count=count))
    session.flush()
    newest = session.scalar(select(func.max(QuarantineRow.id))) or 0
    session.execute(delete(QuarantineRow).where(QuarantineRow.id <= newest - KEPT_ROWS))


def newest(
    session: Session, *, reason: str | None, machine_id: str | None, limit: int, after: Keys | None = None
) -> Sequence[QuarantineRow]:
    """Return the rejections that are still kept, newest first. after: id of the last one of the page before."""
    query = ordered(select(QuarantineRow), (QuarantineRow.id,), after).limit(limit)
    if reason is not None:
        query = query.where(QuarantineRow.reason == reason)
    if machine_id is not None:
        query = query.where(QuarantineRow.machine_id == machine_id)
    return session.scalars(query).all()


def counts(session: Session) -> dict[str, int]:
    """Return the number of all rejections so far, by reason."""
    query = select(QuarantineCountRow.reason, QuarantineCountRow.count).order_by(QuarantineCountRow.reason)
    return {reason: count for reason, count in session.execute(query)}  # noqa: C416 - dict() loses the types


def purge(session: Session, *, before: int | None, reason: str | None) -> int:
    """Delete entries received before a time [ns], or with a reason, or both; return their number.

    The counts stay as they are.
    """
    query = delete(QuarantineRow)
    if before is not None:
        query = query.where(QuarantineRow.received_at < before)
    if reason is not None:
        query = query.where(QuarantineRow.reason == reason)
    return int(cast("CursorResult[Any]", session.execute(query)).rowcount)
