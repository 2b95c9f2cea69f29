"""Applying an assessment: the diagnosis that is stored, and the alerts that are opened, updated or cleared.

`conclusions` is a pure function of the context, the assessment and the machine's present state; `apply` only writes.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from datetime import datetime
from typing import TYPE_CHECKING, Any

from sqlalchemy.orm import Session

from service.alerts import transitions
from service.alerts.lifecycle import ACTIVE, Severity
from service.alerts.transitions import AlertFinding
from service.monitoring.assessment.context import (
    Assessment,
    AssessmentContext,
    DiagnosedCause,
    MachineDiagnosis,
    RateAssessment,
    StoredNumbers,
)
from service.monitoring.context_loading import MonitoringState, diagnosed_kind
from service.monitoring.finding_text import Statement
from service.monitoring.rules.diagnosis_rules import cause_severity
from service.monitoring.rules.drift_rule import RATE_OF_CHANGE
from service.monitoring.rules.finding_catalogue import DIAGNOSIS_RULES, finding_rule
from service.monitoring.rules.limits import Limits
from storage.clock import from_datetime, to_datetime
from storage.findings import diagnoses
from storage.tables.alerting import AlertRow
from storage.tables.findings import IdentificationRow

if TYPE_CHECKING:
    from service.monitoring.assessment.rate_of_change import RateFinding


@dataclass(frozen=True)
class RaisedAlert:
    """An alert to be opened or updated."""

    rule: str
    element: str
    finding: AlertFinding


@dataclass(frozen=True)
class Conclusions:
    """Consequences of an assessment. statements: statements of the diagnosis, None without one.

    changes: alerts to be raised, and those to be cleared, in their order; alerts of rates come first.
    """

    statements: Sequence[Statement] | None
    changes: Sequence[RaisedAlert | AlertRow]


def apply(
    session: Session,
    stored: IdentificationRow,
    context: AssessmentContext,
    assessment: Assessment,
    state: MonitoringState,
) -> None:
    """Store the diagnosis of an identification; open, update or clear the machine's alerts. state: the machine's present
    state."""
    found = conclusions(context, assessment, state)
    if assessment.diagnosis is not None and found.statements is not None:
        diagnoses.add(
            session,
            stored,
            baseline=list(assessment.diagnosis.baseline),
            runs=max((len(one.cause.agreement) for one in assessment.diagnosis.causes), default=0),
            causes=[one.evidence() for one in found.statements],
        )
    for change in found.changes:
        if isinstance(change, RaisedAlert):
            transitions.raise_alert(
                session, stored.machine_id, rule=change.rule, element=change.element, finding=change.finding
            )
        else:
            transitions.clear_alert(session, change)


def conclusions(context: AssessmentContext, assessment: Assessment, state: MonitoringState) -> Conclusions:
    """Return the consequences of an assessment.

    Alerts show the machine's present state: a late run is diagnosed, and affects alerts with the next run.
    """
    diagnosis, changes = assessment.diagnosis, list[RaisedAlert | AlertRow]()
    opened = {(alert.rule, alert.element): alert for alert in state.open_alerts}
    if assessment.rates is not None and state.current:
        changes += _rate_changes(context.limits, assessment.rates, state, opened)
    if diagnosis is None:
        return Conclusions(None, changes)
    statements = [_statement(one, diagnosis, context.numbers, opened) for one in diagnosis.causes]
    if state.current:
        changes += _cause_changes(context.limits, diagnosis, statements, state, opened)
    return Conclusions(statements, changes)


_OpenAlerts = Mapping[tuple[str, str], AlertRow]
"""Open alerts by rule and element."""


def _statement(found: DiagnosedCause, diagnosis: MachineDiagnosis, numbers: StoredNumbers, opened: _OpenAlerts) -> Statement:
    cause = found.cause
    since, first = _first_run_of(found, opened)
    force = finding_rule(cause.kind).force
    return Statement(
        cause=cause,
        runners_up=found.runners_up,
        size=found.size,
        since=since,
        first_identification=first,
        force=None if force is None else numbers.forces.get(f"{cause.element}.{force}"),
        form=found.form,
        progress=found.progress,
        moved=diagnosis.moved,
        not_estimable=numbers.not_estimable,
        second_order=found.second_order,
    )


def _first_run_of(found: DiagnosedCause, opened: _OpenAlerts) -> tuple[int, int]:
    """Return when the first run that shows a cause was measured [ns], and that run's identification.

    Never later than its open alert says: compared with a grown change, the runs with which it began look healthy.
    """
    cause = found.cause
    known = opened.get((finding_rule(cause.kind).rule.name, cause.element))
    if known is None or known.evidence.get("kind") != cause.kind:
        return found.began_at, found.began
    since = from_datetime(datetime.fromisoformat(known.evidence["since"]))
    return min((found.began_at, found.began), (since, int(known.evidence["first_identification"])))


def _cause_changes(
    limits: Limits,
    diagnosis: MachineDiagnosis,
    statements: Sequence[Statement],
    state: MonitoringState,
    opened: _OpenAlerts,
) -> list[RaisedAlert | AlertRow]:
    stored, baseline = state.terms.identification, list(diagnosis.baseline)
    raised = [alert for one in statements if (alert := _alert_of(one, stored, limits, baseline, opened)) is not None]
    updated = {(one.rule, one.element) for one in raised}
    cleared = [
        alert
        for alert in state.open_alerts
        if alert.rule in DIAGNOSIS_RULES
        and (alert.rule, alert.element) not in updated
        and (diagnosed_kind(alert), alert.element) in diagnosis.gone
        and _may_clear(alert, stored)
    ]
    return [*raised, *cleared]


def _alert_of(
    one: Statement, stored: IdentificationRow, limits: Limits, baseline: list[int], opened: _OpenAlerts
) -> RaisedAlert | None:
    """Return the alert of a cause that reaches a limit; None for one that does not. baseline: ids it was compared with."""
    rule, element = finding_rule(one.cause.kind).rule, one.cause.element
    present = opened.get((rule.name, element))
    severity = cause_severity(
        limits,
        kind=one.cause.kind,
        element=element,
        sigma=one.cause.distance,
        size=one.size,
        force=one.force,
        present=None if present is None else Severity(present.severity),
    )
    if severity is None:
        return None
    finding = AlertFinding(
        evidence=one.evidence() | _of_run(stored) | {"baseline": baseline},
        identification_id=stored.id,
        measured_at=stored.measured_at,
        severity=severity,
        latching=rule.limits is not None and limits.rule(rule.name, element).latching,
    )
    return RaisedAlert(rule.name, element, _of_newest_run(finding, present))


def _of_newest_run(finding: AlertFinding, present: AlertRow | None) -> AlertFinding:
    """Return what an open alert says after a finding: the numbers of the run that was measured last.

    A run-up may be identified after the run-down that followed it. present: the open alert.
    """
    if present is None or present.measured_at <= finding.measured_at or present.condition not in ACTIVE:
        return finding
    same_kind = present.evidence.get("kind") == finding.evidence["kind"]
    began = {name: finding.evidence[name] for name in _BEGAN if name in finding.evidence} if same_kind else {}
    return replace(
        finding,
        evidence=present.evidence | began,
        identification_id=present.identification_id,
        measured_at=present.measured_at,
        severity=Severity(present.severity),
    )


_BEGAN = ("since", "first_identification")
"""Evidence of when a finding was first seen, which an older run may put back."""


def _of_run(stored: IdentificationRow) -> dict[str, Any]:
    """Return which run showed a finding last."""
    moment = to_datetime(stored.measured_at).isoformat().replace("+00:00", "Z")
    return {"identification": stored.id, "run_kind": stored.run_kind, "measured_at": moment}


def _may_clear(alert: AlertRow, stored: IdentificationRow) -> bool:
    # A hot run-down may show what a cold run-up does not: only the kind of run that raised an alert can clear it.
    return alert.evidence.get("run_kind") == stored.run_kind


def _rate_changes(
    limits: Limits, rates: RateAssessment, state: MonitoringState, opened: _OpenAlerts
) -> list[RaisedAlert | AlertRow]:
    """Return the alerts of elements that change too fast, whatever the size of the change so far, and those to be cleared."""
    stored = state.terms.identification
    rule = RATE_OF_CHANGE.name
    raised = [
        _alert_of_rate(one, stored, latching=limits.rule(rule, one.element).latching, present=opened.get((rule, one.element)))
        for one in rates.findings
    ]
    cleared = [
        alert
        for alert in state.open_alerts
        if alert.rule == rule and alert.element in rates.gone and _may_clear(alert, stored)
    ]
    return [*raised, *cleared]


def _alert_of_rate(one: "RateFinding", stored: IdentificationRow, *, latching: bool, present: AlertRow | None) -> RaisedAlert:
    evidence = {"kind": RATE_OF_CHANGE.name, "element": one.element, "parameter": one.rate.name, "runs": one.rate.runs}
    evidence |= {f"{bound}_per_cent": 100.0 * getattr(one.rate, bound) for bound in ("per_week", "lower", "upper")}
    evidence |= {"change_per_cent": one.change_per_cent, "ahead": None if one.ahead is None else asdict(one.ahead)}
    finding = AlertFinding(
        evidence=evidence | _of_run(stored),
        identification_id=stored.id,
        measured_at=stored.measured_at,
        severity=one.severity,
        latching=latching,
    )
    return RaisedAlert(RATE_OF_CHANGE.name, one.element, _of_newest_run(finding, present))
