"""A stamp of everything in the store that enters a machine's report: equal stamps mean that nothing has changed."""

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from storage.findings import trends
from storage.tables.alerting import AlertEventRow, AlertRow
from storage.tables.machines import BalancingRow, TimelineRow
from storage.tables.measurements import RunRow

ReportStamp = tuple[int | None, ...]


def report_stamp(session: Session, machine_id: str) -> ReportStamp:
    """Return the stamp of a machine's report."""
    newest = [
        select(func.max(column)).where(row.machine_id == machine_id)
        for row, column in (
            (AlertEventRow, AlertEventRow.id),
            (AlertRow, AlertRow.updated_at),
            (TimelineRow, TimelineRow.id),
            (RunRow, RunRow.id),
            (RunRow, RunRow.time_last),
            (RunRow, RunRow.released_at),
            (BalancingRow, BalancingRow.updated_at),
        )
    ]
    (row,) = session.execute(select(*(part.scalar_subquery() for part in newest))).all()
    return (*trends.stamp(session, machine_id), *row)
