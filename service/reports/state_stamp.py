"""A stamp of everything in the store that enters a machine's report: equal stamps mean that nothing has changed."""

from decimal import Decimal
from typing import Any

from sqlalchemy import ColumnElement, func, select
from sqlalchemy.orm import Session

from storage.findings import trends
from storage.tables.alerting import AlertEventRow, AlertRow
from storage.tables.machines import BalancingRow, TimelineRow
from storage.tables.measurements import RunRow

ReportStamp = tuple[int | Decimal | None, ...]
PRIME = 2**31 - 1
"""Divisor of times [ns] whose remainders are added: their sum stays small, and steps of whole seconds change it."""


def report_stamp(session: Session, machine_id: str) -> ReportStamp:
    """Return the stamp of a machine's report."""
    parts = [
        select(part).where(row.machine_id == machine_id)
        for row, part in (
            (AlertEventRow, func.max(AlertEventRow.id)),
            (AlertRow, _times(AlertRow.updated_at)),
            (TimelineRow, func.max(TimelineRow.id)),
            (RunRow, func.max(RunRow.id)),
            (RunRow, _times(RunRow.time_last)),
            (RunRow, func.sum(RunRow.times_reopened)),
            (RunRow, _times(RunRow.released_at)),
            (BalancingRow, _times(BalancingRow.updated_at)),
        )
    ]
    (row,) = session.execute(select(*(part.scalar_subquery() for part in parts))).all()
    return (*trends.stamp(session, machine_id), *row)


def _times(column: Any) -> ColumnElement[Any]:
    """Return what changes with any of the times: the newest does not where a clock was ahead once."""
    return func.sum(column % PRIME)
