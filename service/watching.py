"""What a new identification says about its machine: misalignment against the baseline, and the alert row that follows."""

import math
from dataclasses import asdict, dataclass
from typing import Any

from sqlalchemy.orm import Session

from estimator.baseline import CommonShift
from estimator.misalignment import MisalignmentEvidence, misalignment_evidence
from storage import alerts, identifications, jobs, machines
from storage.tables import IdentificationRow

MISALIGNMENT = "misalignment"
IN_A_ROW = 2
"""Identifications in a row that must agree before an alert is opened or closed: the on and off delay."""


@dataclass(frozen=True)
class Judgement:
    """What the newest identifications of one kind of run say about one coupling, newest first."""

    evidence: list[MisalignmentEvidence]
    identification: IdentificationRow


def judge(session: Session, stored: IdentificationRow, *, baseline_runs: int) -> None:
    """Open, update or close the machine's misalignment alerts after an identification was stored."""
    if stored.scope != jobs.RUN or not stored.accepted:
        return
    for judgement in judgements(session, stored, baseline_runs=baseline_runs):
        _act(session, judgement)


def judgements(session: Session, stored: IdentificationRow, *, baseline_runs: int) -> list[Judgement]:
    """One judgement per coupling; none while the baseline is incomplete or nothing came after it.

    The baseline is the first accepted identifications of the same machine revision and kind of run, so that like is
    compared with like.
    """
    first = identifications.first_accepted(
        session, stored.machine_id, revision=stored.revision, run_kind=stored.run_kind, limit=baseline_runs
    )
    newest = identifications.last_accepted(
        session, stored.machine_id, revision=stored.revision, run_kind=stored.run_kind, limit=IN_A_ROW
    )
    in_baseline = {row.id for row in first}
    after = [row for row in newest if row.id not in in_baseline]
    if len(first) < baseline_runs or len(after) < IN_A_ROW:
        return []
    machine = machines.document(session, stored.machine_id, stored.revision)
    baseline = [identifications.logarithmic_point(session, row) for row in first]
    per_run = [misalignment_evidence(machine, baseline, identifications.logarithmic_point(session, row)) for row in after]
    return [Judgement(list(of_coupling), after[0]) for of_coupling in zip(*per_run, strict=True)]


def _act(session: Session, judgement: Judgement) -> None:
    newest = judgement.evidence[0]
    element = f"coupling.{newest.coupling}"
    row = judgement.identification
    if all(evidence.found for evidence in judgement.evidence):
        alerts.raise_alert(
            session,
            row.machine_id,
            rule=MISALIGNMENT,
            element=element,
            message=_message(newest),
            evidence=_evidence(newest, row),
            identification_id=row.id,
            measured_at=row.measured_at,
        )
        return
    open_alert = alerts.open_alert(session, row.machine_id, rule=MISALIGNMENT, element=element)
    if open_alert is not None and not any(evidence.found for evidence in judgement.evidence):
        alerts.close_alert(open_alert)


def _message(evidence: MisalignmentEvidence) -> str:
    parts = [f"Coupling {evidence.coupling} is going out of alignment"]
    if evidence.coupling_alone is not None and evidence.bearings_alone is not None:
        parts.append(f"stiffness {_shift(evidence.coupling_alone)} at the coupling")
        parts.append(f"{_shift(evidence.bearings_alone)} at the bearings beside it, against the baseline")
    return ": ".join([parts[0], ", ".join(parts[1:])])


def _shift(shift: CommonShift) -> str:
    return f"{100 * math.expm1(shift.shift):+.0f} % ({shift.statistic:.1f} σ)"


def _evidence(evidence: MisalignmentEvidence, row: IdentificationRow) -> dict[str, Any]:
    return asdict(evidence) | {"identification": row.id, "run_kind": row.run_kind}
