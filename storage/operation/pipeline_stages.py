"""Counts of the pipeline's stages over a stretch of time."""

from dataclasses import dataclass
from typing import Any

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from storage.alerts.deliveries import GIVEN_UP, PENDING
from storage.clock import latest
from storage.findings import jobs
from storage.tables.alerting import AlertRow, DeliveryRow
from storage.tables.findings import DiagnosisRow, IdentificationRow, JobRow
from storage.tables.machines import MachineRow
from storage.tables.measurements import QuarantineRow, RunRow, SourceRow


@dataclass(frozen=True)
class StageFigures:
    """Counts since a time, except those named `_now` and `_ever`; newest times in ns since 1970, None before any."""

    machines_now: int
    newest_sample: int | None
    sending_machines: int
    rejected: int
    lost_ever: int
    runs: int
    open_runs_now: int
    newest_run: int | None
    waiting_jobs_now: int
    failed_jobs: int
    identifications: int
    accepted: int
    newest_identification: int | None
    diagnoses: int
    newest_diagnosis: int | None
    open_alerts_now: int
    newest_alert: int | None
    waiting_deliveries_now: int
    overdue_deliveries_now: int
    given_up_deliveries: int


def figures(session: Session, *, since: int, overdue: int) -> StageFigures:
    """Return the counts since a time [ns]. overdue: deliveries whose next attempt lies before that time [ns] are overdue."""

    def one(query: Any) -> Any:
        return session.scalar(query)

    def count(*conditions: Any) -> int:
        return one(select(func.count()).where(*conditions)) or 0

    until = latest()
    heard = select(func.count(func.distinct(SourceRow.machine_id))).where(SourceRow.last_time.between(since, until))
    pending = DeliveryRow.state == PENDING
    return StageFigures(
        machines_now=one(select(func.count()).select_from(MachineRow)) or 0,
        newest_sample=one(select(func.max(SourceRow.last_time)).where(SourceRow.last_time <= until)) or None,
        sending_machines=one(heard) or 0,
        rejected=count(QuarantineRow.received_at >= since),
        lost_ever=int(one(select(func.sum(SourceRow.lost))) or 0),
        runs=count(RunRow.time_first >= since),
        open_runs_now=count(RunRow.state == "open"),
        newest_run=one(select(func.max(RunRow.time_first)).where(RunRow.time_first <= until)),
        waiting_jobs_now=count(JobRow.state.in_((jobs.QUEUED, jobs.RUNNING))),
        failed_jobs=count(JobRow.state == jobs.FAILED, JobRow.finished_at >= since),
        identifications=count(IdentificationRow.computed_at >= since),
        accepted=count(IdentificationRow.computed_at >= since, IdentificationRow.accepted),
        newest_identification=one(select(func.max(IdentificationRow.computed_at))),
        diagnoses=count(DiagnosisRow.made_at >= since),
        newest_diagnosis=one(select(func.max(DiagnosisRow.made_at))),
        open_alerts_now=count(AlertRow.closed_at.is_(None)),
        newest_alert=one(select(func.max(AlertRow.updated_at))),
        waiting_deliveries_now=count(pending),
        overdue_deliveries_now=count(pending, DeliveryRow.next_try_at < overdue),
        given_up_deliveries=count(DeliveryRow.state == GIVEN_UP, DeliveryRow.last_try_at >= since),
    )
