"""What a new identification says about its machine: a question to a worker, and the alerts that follow from its answer.

Nothing is computed here: `question` reads what `service.judgement` needs, `carry_out` writes what follows.
"""

from collections.abc import Sequence
from datetime import datetime
from typing import TYPE_CHECKING

from sqlalchemy.orm import Session

from estimator.point import Point
from service import alerting
from service.alert_life import Severity
from service.alerting import Finding
from service.comparing import WEEK, compared
from service.diagnosis_rules import cause_severity
from service.finding_rules import DIAGNOSIS_RULES, RATE_OF_CHANGE, finding_rule, is_finding
from service.judgement import Conditions, FoundCause, History, JudgedRun, Judgement, Question, Rates
from service.limits import Limits
from service.setting_limits import limits_in_force
from service.statements import Statement
from storage import alerts, baselines, derived, diagnoses, identifications, jobs, limits, machines
from storage.clock import from_datetime, now
from storage.tables import AlertRow, IdentificationRow

if TYPE_CHECKING:
    from service.rate_of_change import RateFinding

LOOKED_BACK = 60
"""Newest identifications of single runs that are looked at: for when a change began, and for delays of up to 20."""


def question(session: Session, stored: IdentificationRow, *, baseline_runs: int) -> Question | None:
    """What is to be judged after an identification was stored; None where nothing is, as of one that no trend follows."""
    if stored.scope != jobs.RUN:
        return None
    opened = alerts.open_alerts(session, stored.machine_id)
    baseline, after = _runs(session, stored, baseline_runs=baseline_runs)
    return Question(
        machine=machines.document(session, stored.machine_id, stored.revision),
        limits=limits_in_force(session, stored.machine_id),
        basis=_basis(session, stored),
        baseline=baseline,
        after=after,
        speaking=tuple((_kind(one), one.element) for one in opened if one.rule in DIAGNOSIS_RULES and is_finding(_kind(one))),
        rates=_history(session, stored, baseline_runs=baseline_runs),
        drifting={one.element: Severity(one.severity) for one in opened if one.rule == RATE_OF_CHANGE.name},
    )


def carry_out(session: Session, stored: IdentificationRow, asked: Question, answer: Judgement) -> None:
    """Store what an identification led to; open, update or clear the machine's alerts.

    Alerts speak of the machine as it is: a late run is diagnosed, and shows in alerts with the next run.
    """
    today = is_of_today(session, stored)
    if answer.rates is not None and today:
        _carry_out_rates(session, stored, asked.limits, answer.rates)
    found = answer.diagnosis
    if found is None:
        return
    statements = [_statement(session, stored, one) for one in found.causes]
    diagnoses.keep(
        session,
        stored,
        baseline=list(found.baseline),
        runs=max((len(one.cause.agreement) for one in found.causes), default=0),
        causes=[one.evidence() for one in statements],
    )
    if not today:
        return
    raised = {
        alert.id
        for one in statements
        if (alert := _raise(session, one, stored, asked.limits, list(found.baseline))) is not None
    }
    for alert in alerts.open_alerts(session, stored.machine_id):
        gone = (_kind(alert), alert.element) in found.gone
        if alert.rule in DIAGNOSIS_RULES and alert.id not in raised and gone and _may_clear(alert, stored):
            alerting.clear_alert(session, alert)


def still_holds(session: Session, stored: IdentificationRow, asked: Question) -> bool:
    """Whether baseline and limits are still those that a question was asked with; a person may have changed them meanwhile."""
    return asked.basis == _basis(session, stored)


def _basis(session: Session, stored: IdentificationRow) -> tuple[int | None, int | None]:
    """The baseline that a person began, and the limits that one set, as they are in force."""
    baseline = baselines.in_force(session, stored.machine_id, at=stored.measured_at)
    chosen = limits.in_force(session, stored.machine_id)
    return None if baseline is None else baseline.id, None if chosen is None else chosen.version


def is_of_today(session: Session, stored: IdentificationRow) -> bool:
    """Whether a run shows the machine as it is: the newest of its kind, under the document and the baseline in force."""
    newest = machines.get(session, stored.machine_id).revision
    then, today = (baselines.in_force(session, stored.machine_id, at=moment) for moment in (stored.measured_at, now()))
    same_machine = stored.revision in machines.comparable(session, stored.machine_id, newest)
    return same_machine and then is today and identifications.is_newest(session, stored)


def _runs(
    session: Session, stored: IdentificationRow, *, baseline_runs: int
) -> tuple[tuple[JudgedRun, ...], tuple[JudgedRun, ...]]:
    """The baseline and the newest runs up to an identification, accepted or not.

    None of them while the baseline is incomplete, where the run is part of it or covers other speeds, or where an older
    release identified: that says nothing of the channels.
    """
    rows = compared(session, stored, baseline_runs=baseline_runs, accepted=False, longest=LOOKED_BACK)
    baseline = _judged_runs(rows.baseline)
    if not len(baseline) == rows.wanted > 0:
        return (), ()
    complete = rows.baseline[-1].measured_at
    # What was refused while the baseline was gathered is not the newest of anything.
    after = _judged_runs([row for row in rows.after if row.accepted or row.measured_at > complete])
    return (baseline, after) if after and after[-1].id == stored.id else ((), ())


def _judged_runs(rows: Sequence[IdentificationRow]) -> tuple[JudgedRun, ...]:
    said = [(row, fit) for row in rows if (fit := identifications.fit(row)) is not None]
    return tuple(JudgedRun(row.id, row.measured_at, row.conditions or {}, fit) for row, fit in said)


def _history(session: Session, stored: IdentificationRow, *, baseline_runs: int) -> History | None:
    """What rates of change are judged by; None where the run is not accepted, or not of today."""
    if not stored.accepted or not is_of_today(session, stored):
        return None
    rows = compared(session, stored, baseline_runs=baseline_runs, longest=LOOKED_BACK)
    if rows.missing is not None:
        return None
    conditions = machines.document(session, stored.machine_id, stored.revision).conditions
    return History(
        conditions=conditions,
        baseline=_points(session, rows.baseline) if conditions else [],
        times=[row.measured_at / WEEK for row in rows.after],
        after=_points(session, rows.after),
    )


def _points(session: Session, rows: Sequence[IdentificationRow]) -> list[tuple[Point, Conditions]]:
    known = identifications.points(session, rows)
    return [(known[row.id], row.conditions or {}) for row in rows if row.id in known]


def _kind(alert: AlertRow) -> str:
    return str(alert.evidence.get("kind", alert.rule))


def _statement(session: Session, stored: IdentificationRow, found: FoundCause) -> Statement:
    cause = found.cause
    since, first = _since(session, stored.machine_id, found)
    of_force = finding_rule(cause.kind).force
    force = None if of_force is None else derived.value(session, stored.id, f"{cause.element}.{of_force}")
    return Statement(cause, found.runners_up, found.size, since, first, force, found.form, found.units)


def _since(session: Session, machine_id: str, found: FoundCause) -> tuple[int, int]:
    """When the first run that shows a cause was measured [ns], and that run's identification.

    Never later than its open alert says: against a change that has grown, the runs with which it began look like healthy ones.
    """
    cause = found.cause
    known = alerts.open_alert(session, machine_id, rule=finding_rule(cause.kind).rule.name, element=cause.element)
    if known is None or known.evidence.get("kind") != cause.kind:
        return found.began_at, found.began
    said = from_datetime(datetime.fromisoformat(known.evidence["since"]))
    return min((found.began_at, found.began), (said, int(known.evidence["first_identification"])))


def _raise(
    session: Session, one: Statement, stored: IdentificationRow, chosen: Limits, baseline: list[int]
) -> AlertRow | None:
    """Open an alert or bring it up to date, where a limit is reached. baseline: ids of what it was compared with."""
    rule, element = finding_rule(one.cause.kind).rule, one.cause.element
    present = alerts.open_alert(session, stored.machine_id, rule=rule.name, element=element)
    severity = cause_severity(
        chosen,
        kind=one.cause.kind,
        element=element,
        sigma=one.cause.distance,
        per_cent=one.size.per_cent,
        force=one.force,
        present=None if present is None else Severity(present.severity),
    )
    if severity is None:
        return None
    finding = Finding(
        message=one.words(),
        evidence=one.evidence() | {"identification": stored.id, "run_kind": stored.run_kind, "baseline": baseline},
        identification_id=stored.id,
        measured_at=stored.measured_at,
        severity=severity,
        latching=rule.limits is not None and chosen.rule(rule.name, element).latching,
    )
    return alerting.raise_alert(session, stored.machine_id, rule=rule.name, element=element, finding=finding)


def _may_clear(alert: AlertRow, stored: IdentificationRow) -> bool:
    # A hot run-down may show what a cold run-up does not: only the kind of run that showed it can take it back.
    return alert.evidence.get("run_kind") == stored.run_kind


def _carry_out_rates(session: Session, stored: IdentificationRow, chosen: Limits, found: Rates) -> None:
    """Open, update or clear the alerts of elements that change too fast, whatever the size of the change so far."""
    for one in found.findings:
        latching = chosen.rule(RATE_OF_CHANGE.name, one.element).latching
        _raise_rate(session, stored, one, latching=latching)
    for alert in alerts.open_alerts(session, stored.machine_id):
        if alert.rule == RATE_OF_CHANGE.name and alert.element in found.gone and _may_clear(alert, stored):
            alerting.clear_alert(session, alert)


def _raise_rate(session: Session, stored: IdentificationRow, one: "RateFinding", *, latching: bool) -> None:
    evidence = {"kind": RATE_OF_CHANGE.name, "element": one.element, "parameter": one.rate.name, "runs": one.rate.runs}
    evidence |= {f"{what}_per_cent": 100.0 * getattr(one.rate, what) for what in ("per_week", "lower", "upper")}
    finding = Finding(
        message=one.message,
        evidence=evidence | {"identification": stored.id, "run_kind": stored.run_kind},
        identification_id=stored.id,
        measured_at=stored.measured_at,
        severity=one.severity,
        latching=latching,
    )
    alerting.raise_alert(session, stored.machine_id, rule=RATE_OF_CHANGE.name, element=one.element, finding=finding)
