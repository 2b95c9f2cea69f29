"""Repository of diagnoses: the causes that each identification indicated when it was filed, and the baseline it was compared
with."""

from collections.abc import Sequence
from typing import Any

from sqlalchemy import select
from sqlalchemy.orm import Session

from storage.clock import now
from storage.tables.findings import DiagnosisRow, IdentificationRow


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


def newest(session: Session, machine_id: str, *, last: int | None = None) -> DiagnosisRow | None:
    """Return the diagnosis of a machine's newest run that has one. last: measured up to this time [ns]."""
    query = select(DiagnosisRow).where(DiagnosisRow.machine_id == machine_id)
    if last is not None:
        query = query.where(DiagnosisRow.measured_at <= last)
    query = query.order_by(DiagnosisRow.measured_at.desc(), DiagnosisRow.identification_id.desc())
    return session.scalars(query.limit(1)).one_or_none()


def named_causes(row: DiagnosisRow | None) -> tuple[tuple[str, str], ...]:
    """Return kind and element of the causes of a diagnosis; none without one."""
    return () if row is None else tuple((one["kind"], one["element"]) for one in row.causes)
