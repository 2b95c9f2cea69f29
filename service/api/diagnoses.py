"""What identifications say of their machine: causes with evidence and runners-up, against the baseline."""

from datetime import datetime
from typing import Any

from fastapi import APIRouter
from pydantic import BaseModel, Field

from service.api.access import MachineId, Number, Reading
from service.api.problems import RESPONSES, Unsuitable
from service.security.requirement import VIEWER
from storage import diagnoses, identifications, machines
from storage.clock import to_datetime
from storage.tables import DiagnosisRow

router = APIRouter(tags=["diagnosis"], responses=RESPONSES, dependencies=[VIEWER])


class DiagnosisOut(BaseModel):
    """What an identification said of its machine when it was filed."""

    identification: int
    machine: str
    measured_at: datetime
    made_at: datetime
    baseline: list[int] = Field(description="ids of the identifications that it was compared with")
    runs: int = Field(description="newest runs that were looked at together; 0 where they showed nothing")
    causes: list[dict[str, Any]] = Field(
        description="strongest first, each with kind, element, evidence, sigma, per_cent, since, moved, runners_up"
    )


@router.get("/identifications/{identification_id}/diagnosis", operation_id="read_diagnosis")
def read_diagnosis(session: Reading, identification_id: Number) -> DiagnosisOut:
    """What an identification said of its machine when it was filed, also where that reached no limit."""
    identifications.get(session, identification_id)
    return _answer(diagnoses.of_identification(session, identification_id), f"identification {identification_id}")


@router.get("/machines/{machine_id}/diagnosis", operation_id="read_newest_diagnosis")
def read_newest_diagnosis(session: Reading, machine_id: MachineId) -> DiagnosisOut:
    """The diagnosis of the machine's newest run that has one."""
    machines.get(session, machine_id)
    return _answer(diagnoses.newest(session, machine_id), f"machine '{machine_id}'")


def _answer(row: DiagnosisRow | None, what: str) -> DiagnosisOut:
    if row is None:
        raise Unsuitable(f"{what} has no diagnosis: its baseline is not complete, or it was identified by an older release")
    return DiagnosisOut(
        identification=row.identification_id,
        machine=row.machine_id,
        measured_at=to_datetime(row.measured_at),
        made_at=to_datetime(row.made_at),
        baseline=row.baseline,
        runs=row.runs,
        causes=row.causes,
    )
