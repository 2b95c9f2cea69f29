"""Serves diagnoses: causes with their evidence and runners-up, against the baseline."""

from datetime import datetime
from typing import Any

from fastapi import APIRouter, Request
from pydantic import BaseModel, Field
from sqlalchemy.orm import Session

from estimator.rotor.parameter_names import parameter_units
from service.advice.advice import FindingFacts, advice_of
from service.advice.site_texts import SiteTexts
from service.alerts.advice_message import Advice
from service.alerts.lifecycle import Severity
from service.api.conventions.dependencies import MachineId, Number, Reading
from service.api.conventions.problems import RESPONSES, Unsuitable
from service.api.conventions.reader_language import VARIES_BY_LANGUAGE, reader_language
from service.api.findings.evidence import CauseOut, with_moved_in_per_cent
from service.security.requirement import VIEWER
from storage.alerts import alerts
from storage.clock import to_datetime
from storage.findings import diagnoses, identifications
from storage.machines import machines
from storage.tables.findings import DiagnosisRow

router = APIRouter(tags=["diagnosis"], responses=RESPONSES, dependencies=[VIEWER, VARIES_BY_LANGUAGE])

MOST_ALERTS = 1000
"""Most open alerts of a machine that are looked through."""


class ToldCause(CauseOut):
    """A cause of a change of the machine, and what is told of it."""

    advice: Advice | None = Field(
        description="how far, how sure, how urgent, what to do; null: an older release stored too few numbers"
    )


class DiagnosisOut(BaseModel):
    """Diagnosis of a machine at the time when an identification was stored."""

    identification: int
    machine: str
    measured_at: datetime
    made_at: datetime
    baseline: list[int] = Field(description="ids of the identifications that it was compared with")
    runs: int = Field(description="newest runs that were looked at together; 0 where they showed nothing")
    causes: list[ToldCause] = Field(description="strongest first")


@router.get("/identifications/{identification_id}/diagnosis", operation_id="read_diagnosis")
def read_diagnosis(request: Request, session: Reading, identification_id: Number) -> DiagnosisOut:
    """Read the diagnosis made when an identification was stored, also where it reached no limit."""
    identifications.get(session, identification_id)
    found = diagnoses.of_identification(session, identification_id)
    return _answer(request, session, found, f"identification {identification_id}")


@router.get("/machines/{machine_id}/diagnosis", operation_id="read_newest_diagnosis")
def read_newest_diagnosis(request: Request, session: Reading, machine_id: MachineId) -> DiagnosisOut:
    """Read the diagnosis of the machine's newest run that has one."""
    machines.get(session, machine_id)
    return _answer(request, session, diagnoses.newest(session, machine_id), f"machine '{machine_id}'")


def _answer(request: Request, session: Session, row: DiagnosisRow | None, what: str) -> DiagnosisOut:
    if row is None:
        raise Unsuitable(f"{what} has no diagnosis: its baseline is not complete, or it was identified by an older release")
    revision = identifications.get(session, row.identification_id).revision
    units = parameter_units(machines.document(session, row.machine_id, revision))
    severities = _severities(session, row)
    texts: SiteTexts = request.app.state.texts.in_language(reader_language(request))
    return DiagnosisOut(
        identification=row.identification_id,
        machine=row.machine_id,
        measured_at=to_datetime(row.measured_at),
        made_at=to_datetime(row.made_at),
        baseline=row.baseline,
        runs=row.runs,
        causes=[_cause(row, one, units, severities, texts) for one in row.causes],
    )


def _severities(session: Session, row: DiagnosisRow) -> dict[tuple[str, str], Severity]:
    """Return the severity of each open alert that rests on a diagnosis, by kind of finding and element."""
    found = alerts.find(session, machine_id=row.machine_id, only_open=True, limit=MOST_ALERTS)
    own = [one for one in found if one.identification_id == row.identification_id]
    return {(str(one.evidence.get("kind", one.rule)), one.element): Severity(one.severity) for one in own}


def _cause(
    row: DiagnosisRow,
    stored: dict[str, Any],
    units: dict[str, str],
    severities: dict[tuple[str, str], Severity],
    texts: SiteTexts,
) -> ToldCause:
    kind, element = stored["kind"], stored["element"]
    measured_at = to_datetime(row.measured_at)
    facts = FindingFacts(row.machine_id, kind, element, stored, severities.get((kind, element)), measured_at)
    told = CauseOut.model_validate(with_moved_in_per_cent(stored, units))
    return ToldCause(**dict(told), advice=advice_of(facts, texts))
