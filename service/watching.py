"""What a new identification says about its machine: misalignment against the baseline, and the alert row that follows."""

import math
from dataclasses import asdict, dataclass
from typing import Any

from sqlalchemy.orm import Session

from estimator.baseline import CommonShift
from estimator.misalignment import MisalignmentEvidence, determines, misalignment_evidence, watched
from service import alerting
from service.alerting import Finding
from storage import alerts, identifications, jobs, machines
from storage.identifications import Like
from storage.tables import IdentificationRow

MISALIGNMENT = "misalignment"
SEARCHED = 10
"""So many times as many identifications are looked through for those that determine what is watched."""
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
    """One judgement per coupling; none while its baseline is incomplete or too little came after it.

    Like is compared with like: identifications of the same machine revision, kind of run and slow-roll version. Only those
    that determine what is watched at a coupling count there, in its baseline and after it; a run that says nothing changes
    nothing.
    """
    machine = machines.document(session, stored.machine_id, stored.revision)
    which = session, stored.machine_id, Like(stored.revision, stored.run_kind, stored.slow_roll_version)
    first = identifications.first_accepted(*which, limit=SEARCHED * baseline_runs)
    newest = identifications.last_accepted(*which, limit=SEARCHED * IN_A_ROW)
    points = {row.id: identifications.logarithmic_point(session, row) for row in (*first, *newest)}
    found = []
    for coupling in machine.couplings:
        names = watched(machine, coupling)
        baseline = [row for row in first if determines(points[row.id], names)][:baseline_runs]
        in_baseline = {row.id for row in baseline}
        after = [row for row in newest if row.id not in in_baseline and determines(points[row.id], names)][:IN_A_ROW]
        if len(baseline) == baseline_runs and len(after) == IN_A_ROW:
            known = [points[row.id] for row in baseline]
            evidence = [misalignment_evidence(machine, coupling, known, points[row.id]) for row in after]
            found.append(Judgement(evidence, after[0]))
    return found


def _act(session: Session, judgement: Judgement) -> None:
    newest = judgement.evidence[0]
    element = f"coupling.{newest.coupling}"
    row = judgement.identification
    if all(evidence.found for evidence in judgement.evidence):
        finding = Finding(_message(newest), _evidence(newest, row), row.id, row.measured_at)
        alerting.raise_alert(session, row.machine_id, rule=MISALIGNMENT, element=element, finding=finding)
        return
    open_alert = alerts.open_alert(session, row.machine_id, rule=MISALIGNMENT, element=element)
    # A hot run-down may show what a cold run-up does not: only the kind of run that showed it can take it back.
    same_kind = open_alert is not None and open_alert.evidence.get("run_kind") == row.run_kind
    if open_alert is not None and same_kind and not any(evidence.found for evidence in judgement.evidence):
        alerting.clear_alert(session, open_alert)


def _message(evidence: MisalignmentEvidence) -> str:
    parts = [f"stiffness {_shift(evidence.coupling_alone)} at the coupling"]
    if evidence.bearings_alone is not None:
        parts.append(f"{_shift(evidence.bearings_alone)} at the bearings beside it")
    return f"Coupling {evidence.coupling} is going out of alignment: {', '.join(parts)}, against the baseline"


def _shift(shift: CommonShift) -> str:
    return f"{100 * math.expm1(shift.shift):+.0f} % ({shift.statistic:.1f} σ)"


def _evidence(evidence: MisalignmentEvidence, row: IdentificationRow) -> dict[str, Any]:
    return asdict(evidence) | {"identification": row.id, "run_kind": row.run_kind}
