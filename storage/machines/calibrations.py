"""Repository of calibrations: which channel was calibrated when, by whom and with which certificate."""

from collections.abc import Sequence

from sqlalchemy import select
from sqlalchemy.orm import Session

from storage.clock import now
from storage.paging import Keys, between, ordered
from storage.tables.machines import CalibrationRow


def add(session: Session, machine_id: str, *, channel: str, at: int, certificate: str, by: str) -> CalibrationRow:
    """Record that a channel was calibrated at a time [ns]."""
    row = CalibrationRow(machine_id=machine_id, channel=channel, at=at, certificate=certificate, by=by, created_at=now())
    session.add(row)
    session.flush()
    return row


def of_machine(
    session: Session,
    machine_id: str,
    *,
    channel: str | None = None,
    first: int | None = None,
    last: int | None = None,
    limit: int,
    after: Keys | None = None,
) -> Sequence[CalibrationRow]:
    """Return calibrations between two times [ns], newest first. after: (time, id) of the last one of the page before."""
    query = select(CalibrationRow).where(CalibrationRow.machine_id == machine_id)
    if channel is not None:
        query = query.where(CalibrationRow.channel == channel)
    query = between(query, CalibrationRow.at, first, last)
    return session.scalars(ordered(query, (CalibrationRow.at, CalibrationRow.id), after).limit(limit)).all()
