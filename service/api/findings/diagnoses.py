"""Serves diagnoses: causes with their evidence and runners-up, against the baseline."""

from datetime import datetime
from typing import Any

from fastapi import APIRouter
from pydantic import BaseModel, Field
from sqlalchemy.orm import Session

from estimator.rotor.parameter_names import change_unit, parameter_units
from service.api.conventions.dependencies import MachineId, Number, Reading
from service.api.conventions.problems import RESPONSES, Unsuitable
from service.api.findings.evidence import CauseOut
from service.security.requirement import VIEWER
from storage.clock import to_datetime
from storage.findings import diagnoses, identifications
from storage.machines import machines
from storage.tables.findings import DiagnosisRow

router = APIRouter(tags=["diagnosis"], responses=RESPONSES, dependencies=[VIEWER])


class DiagnosisOut(BaseModel):
    """Diagnosis of a machine at the time when an identification was stored."""

    identification: int
    machine: str
    measured_at: datetime
    made_at: datetime
    baseline: list[int] = Field(description="ids of the identifications that it was compared with")
    runs: int = Field(description="newest runs that were looked at together; 0 where they showed nothing")
    causes: list[CauseOut] = Field(description="strongest first")


@router.get("/identifications/{identification_id}/diagnosis", operation_id="read_diagnosis")
def read_diagnosis(session: Reading, identification_id: Number) -> DiagnosisOut:
    """Read the diagnosis made when an identification was stored, also where it reached no limit."""
    identifications.get(session, identification_id)
    found = diagnoses.of_identification(session, identification_id)
    return _answer(session, found, f"identification {identification_id}")


@router.get("/machines/{machine_id}/diagnosis", operation_id="read_newest_diagnosis")
def read_newest_diagnosis(session: Reading, machine_id: MachineId) -> DiagnosisOut:
    """Read the diagnosis of the machine's newest run that has one."""
    machines.get(session, machine_id)
    return _answer(session, diagnoses.newest(session, machine_id), f"machine '{machine_id}'")


def _answer(session: Session, row: DiagnosisRow | None, what: str) -> DiagnosisOut:
    if row is None:
        raise Unsuitable(f"{what} has no diagnosis: its baseline is not complete, or it was identified by an older release")
    revision = identifications.get(session, row.identification_id).revision
    units = parameter_units(machines.document(session, row.machine_id, revision))
    return DiagnosisOut(
        identification=row.identification_id,
        machine=row.machine_id,
        measured_at=to_datetime(row.measured_at),
        made_at=to_datetime(row.made_at),
        baseline=row.baseline,
        runs=row.runs,
        causes=[_cause(one, units) for one in row.causes],
    )


def _cause(stored: dict[str, Any], units: dict[str, str]) -> CauseOut:
    # Older releases stored no units.
    moved = [{"unit": change_unit(one["parameter"], units)} | one for one in stored["moved"]]
    return CauseOut.model_validate(stored | {"moved": moved})
