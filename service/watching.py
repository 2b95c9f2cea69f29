"""What a new identification says about its machine: misalignment against the baseline, and the alert row that follows."""

import math
from dataclasses import asdict, dataclass
from typing import Any

from sqlalchemy.orm import Session

from estimator.baseline import CommonShift
from estimator.misalignment import MisalignmentEvidence, determines, misalignment_evidence, watched
from service import alerting
from service.alerting import Finding
from storage import alerts, baselines, identifications, jobs, machines
from storage.clock import now
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
    if stored.scope != jobs.RUN or not stored.accepted or _of_the_past(session, stored):
        return
    for judgement in judgements(session, stored, baseline_runs=baseline_runs):
        _act(session, judgement)


def _of_the_past(session: Session, stored: IdentificationRow) -> bool:
    """Whether a late run belongs to the machine as it was: alerts speak of the machine as it is."""
    newest = machines.get(session, stored.machine_id).revision
    if stored.revision not in machines.comparable(session, stored.machine_id, newest):
        return True
    then, today = (baselines.in_force(session, stored.machine_id, at=moment) for moment in (stored.measured_at, now()))
    return then is not today


def judgements(session: Session, stored: IdentificationRow, *, baseline_runs: int) -> list[Judgement]:
    """One judgement per coupling; none while its baseline is incomplete or too little came after it.

    Like is compared with like: identifications under comparable revisions of the machine's document, of the same kind of run
    and slow-roll version, behind the beginning of the baseline in force. Only those that determine what is watched at a
    coupling count there, in its baseline and after it; a run that says nothing changes nothing.
    """
    machine = machines.document(session, stored.machine_id, stored.revision)
    baseline_row = baselines.in_force(session, stored.machine_id, at=stored.measured_at)
    like = Like(
        revisions=tuple(machines.comparable(session, stored.machine_id, stored.revision)),
        run_kind=stored.run_kind,
        slow_roll_version=stored.slow_roll_version,
        since=0 if baseline_row is None else baseline_row.since,
    )
    which = session, stored.machine_id, like
    if baseline_row is None or baseline_row.identification_ids is None:
        first = identifications.first_accepted(*which, limit=SEARCHED * baseline_runs)
        wanted = baseline_runs
    else:
        first = identifications.named(*which, baseline_row.identification_ids)
        wanted = len(first)
    newest = identifications.last_accepted(*which, limit=SEARCHED * IN_A_ROW + wanted)
    points = {row.id: identifications.logarithmic_point(session, row) for row in (*first, *newest)}
    found = []
    for coupling in machine.couplings:
        names = watched(machine, coupling)
        baseline = [row for row in first if determines(points[row.id], names)][:wanted]
        in_baseline = {row.id for row in baseline}
        after = [row for row in newest if row.id not in in_baseline and determines(points[row.id], names)][:IN_A_ROW]
        if len(baseline) == wanted > 0 and len(after) == IN_A_ROW:
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
