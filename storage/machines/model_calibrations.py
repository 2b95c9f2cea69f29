"""Repository of calibrations of a machine's model from runs with known unbalances.

`asked` is an object with fields `runs`, for each run its id (`run`), its `weights` [g mm, °], the name of its `mounting` and
whether its samples are dwells (`steady`), and `seed`.
"""

from collections.abc import Sequence
from typing import Any

from sqlalchemy import select
from sqlalchemy.orm import Session, undefer

from estimator.errors import Missing
from storage.clock import now
from storage.paging import Keys, ordered
from storage.tables.machines import ModelCalibrationRow


class ModelCalibrationUnknown(Missing):
    """Raised when a machine has no calibration of this id."""

    subject = "calibration"


def add(
    session: Session, machine_id: str, *, revision: int, asked: dict[str, Any], by: str, comment: str
) -> ModelCalibrationRow:
    """Store what is asked for, before it is computed."""
    row = ModelCalibrationRow(
        machine_id=machine_id, revision=revision, job_id=None, asked=asked, by=by, comment=comment, created_at=now()
    )
    session.add(row)
    session.flush()
    return row


def get(session: Session, machine_id: str, calibration_id: int, *, to_change: bool = False) -> ModelCalibrationRow:
    """Return a machine's calibration with its document, locked when `to_change`. Raises ModelCalibrationUnknown."""
    row = session.get(
        ModelCalibrationRow,
        calibration_id,
        options=[undefer(ModelCalibrationRow.document)],
        with_for_update=to_change or None,
    )
    if row is None or row.machine_id != machine_id:
        raise ModelCalibrationUnknown(calibration_id)
    return row


def of_machine(session: Session, machine_id: str, *, limit: int, after: Keys | None = None) -> Sequence[ModelCalibrationRow]:
    """Return a machine's calibrations, newest first. after: the id of the last one of the page before."""
    query = select(ModelCalibrationRow).where(ModelCalibrationRow.machine_id == machine_id)
    return session.scalars(ordered(query, (ModelCalibrationRow.id,), after).limit(limit)).all()


def record(
    row: ModelCalibrationRow,
    *,
    accepted: bool,
    verdict: str,
    result: dict[str, Any],
    document: dict[str, Any],
    code_version: str,
) -> None:
    """Record what was computed."""
    row.accepted, row.verdict, row.result, row.document = accepted, verdict, result, document
    row.code_version, row.computed_at = code_version, now()
