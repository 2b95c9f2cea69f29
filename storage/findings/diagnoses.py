"""Repository of diagnoses: the causes that each identification indicated when it was filed, and the baseline it was compared
with."""

from collections.abc import Sequence
from typing import Any

from sqlalchemy import select
from sqlalchemy.orm import Session

from storage.clock import now
from storage.tables.findings import DiagnosisRow, IdentificationRow
from storage.tables.measurements import RunRow


def add(
    session: Session, of: IdentificationRow, *, baseline: Sequence[int], runs: int, causes: list[dict[str, Any]]
) -> DiagnosisRow:
    """Store the diagnosis of an identification. baseline: ids it was compared with; runs: number of runs assessed together."""
    row = session.get(DiagnosisRow, of.id)
    if row is None:
        row = DiagnosisRow(identification_id=of.id, machine_id=of.machine_id, measured_at=of.measured_at)
        session.add(row)
    row.baseline, row.runs, row.causes, row.made_at = list(baseline), runs, causes, now()
    session.flush()
    return row


def of_identification(session: Session, identification_id: int) -> DiagnosisRow | None:
    """Return the diagnosis of an identification; None when its baseline was not complete."""
    return session.get(DiagnosisRow, identification_id)


def newest(session: Session, machine_id: str) -> DiagnosisRow | None:
    """Return the diagnosis of a machine's newest run that has one."""
    query = select(DiagnosisRow).where(DiagnosisRow.machine_id == machine_id)
    query = query.order_by(DiagnosisRow.measured_at.desc(), DiagnosisRow.identification_id.desc())
    return session.scalars(query.limit(1)).one_or_none()


def newest_on_films(
    session: Session, run: RunRow, *, slow_roll_version: int | None, since: int, before: int
) -> DiagnosisRow | None:
    """Return the newest diagnosis of a run of the same kind, revision and slow-roll vectors on oil films, measured within some
    time [ns]."""
    query = select(DiagnosisRow).join(IdentificationRow, IdentificationRow.id == DiagnosisRow.identification_id)
    query = query.where(DiagnosisRow.machine_id == run.machine_id)
    query = query.where(DiagnosisRow.measured_at >= since, DiagnosisRow.measured_at < before)
    query = query.where(IdentificationRow.run_kind == run.kind, IdentificationRow.revision == run.revision)
    query = query.where(IdentificationRow.slow_roll_version.is_not_distinct_from(slow_roll_version))
    query = query.where(IdentificationRow.load_balance.is_not(None))
    query = query.order_by(DiagnosisRow.measured_at.desc(), DiagnosisRow.identification_id.desc())
    return session.scalars(query.limit(1)).one_or_none()


def named_causes(row: DiagnosisRow | None) -> tuple[tuple[str, str], ...]:
    """Return kind and element of the causes of a diagnosis; none without one."""
    return () if row is None else tuple((one["kind"], one["element"]) for one in row.causes)
