"""Repository of runs and of where each machine's run collection stands."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from sqlalchemy import select
from sqlalchemy.orm import Session, undefer

from storage.blocks import Samples, decode, encode
from storage.tables import CollectorRow, RunRow

OPEN, CLOSED, DISCARDED = "open", "closed", "discarded"


class RunUnknown(KeyError):
    """No run of that id."""


def open_run(session: Session, machine_id: str, *, revision: int, kind: str, direction: int, time_first: int) -> RunRow:
    """Record that a run has begun."""
    row = RunRow(
        machine_id=machine_id,
        revision=revision,
        kind=kind,
        direction=direction,
        state=OPEN,
        reason=None,
        time_first=time_first,
        time_last=None,
        speed_minimum=None,
        speed_maximum=None,
        count=None,
        data=None,
    )
    session.add(row)
    session.flush()
    return row


def current(session: Session, machine_id: str) -> RunRow | None:
    """The open run of a machine."""
    query = select(RunRow).where(RunRow.machine_id == machine_id, RunRow.state == OPEN)
    return session.scalars(query).one_or_none()


def close(row: RunRow, *, samples: Samples, state: str, reason: str) -> None:
    """Freeze a run with its samples. `state` is CLOSED, or DISCARDED when the run is not worth an identification."""
    row.state = state
    row.reason = reason
    row.time_last = int(samples.time[-1])
    row.speed_minimum = float(np.min(samples.speed))
    row.speed_maximum = float(np.max(samples.speed))
    row.count = len(samples)
    row.data = encode(samples)


def get(session: Session, run_id: int) -> RunRow:
    """Raises RunUnknown."""
    row = session.get(RunRow, run_id)
    if row is None:
        raise RunUnknown(run_id)
    return row


def samples(session: Session, run_id: int) -> Samples | None:
    """The samples of a closed run; None while it is open. Raises RunUnknown."""
    row = session.get(RunRow, run_id, options=[undefer(RunRow.data)])
    if row is None:
        raise RunUnknown(run_id)
    return None if row.data is None else decode(row.data)


def of_machine(
    session: Session, machine_id: str, *, first: int | None = None, last: int | None = None, limit: int | None = None
) -> Sequence[RunRow]:
    """Runs of a machine that began between two times [ns], newest first."""
    query = select(RunRow).where(RunRow.machine_id == machine_id).order_by(RunRow.time_first.desc())
    if first is not None:
        query = query.where(RunRow.time_first >= first)
    if last is not None:
        query = query.where(RunRow.time_first <= last)
    return session.scalars(query.limit(limit)).all()


def newest_closed(session: Session, machine_id: str, *, revision: int, limit: int) -> Sequence[RunRow]:
    """The newest closed runs of one revision, newest first."""
    query = (
        select(RunRow)
        .where(RunRow.machine_id == machine_id, RunRow.revision == revision, RunRow.state == CLOSED)
        .order_by(RunRow.time_first.desc())
        .limit(limit)
    )
    return session.scalars(query).all()


def collector_state(session: Session, machine_id: str) -> dict[str, Any] | None:
    """Where the machine's collection stood when its newest samples were stored."""
    row = session.get(CollectorRow, machine_id)
    return None if row is None else row.state


def save_collector_state(session: Session, machine_id: str, state: dict[str, Any]) -> None:
    """Keep where the machine's collection stands."""
    row = session.get(CollectorRow, machine_id)
    if row is None:
        session.add(CollectorRow(machine_id=machine_id, state=state))
    else:
        row.state = state
