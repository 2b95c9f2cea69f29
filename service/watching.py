"""What a new identification says about its machine: a diagnosis against the baseline, and the alerts that follow."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime

from sqlalchemy.orm import Session

from estimator.change_size import ChangeSize, change_size
from estimator.covariates import Adjustment, adjustment
from estimator.diagnosis import Cause, Diagnosis
from estimator.healthy_variation import typical_amplitude
from estimator.machine import Machine
from estimator.observation import Observation
from estimator.parameter_names import parameter_units
from estimator.watch import Watch
from service import alerting, watching_rates
from service.alert_life import Severity
from service.alerting import Finding
from service.comparing import compared
from service.limits import Limits, severity_of
from service.setting_limits import limits_in_force
from service.statements import RULES, Statement, rule_of
from storage import alerts, baselines, derived, diagnoses, identifications, jobs, machines
from storage.clock import from_datetime, now
from storage.tables import AlertRow, IdentificationRow

LOOKED_BACK = 60
"""Newest identifications of single runs that are looked at: for when a change began, and for delays of up to 20."""
DATA_RULES = ("misfit", "outliers")
"""What is wrong with the data has no size and no limits …"""
DATA_DELAY = 2
"""… and is an alert after so many runs in a row, and none after so many good ones."""


@dataclass(frozen=True)
class Comparison:
    """A machine's newest runs against its baseline: rows and what they say, oldest first."""

    machine: Machine
    baseline: tuple[IdentificationRow, ...]
    watch: Watch
    after: tuple[IdentificationRow, ...]
    observations: tuple[Observation, ...]


def judge(session: Session, stored: IdentificationRow, *, baseline_runs: int) -> None:
    """Diagnose a machine after an identification was stored; open, update or clear its alerts.

    Alerts speak of the machine as it is: a late run is diagnosed, and shows in alerts with the next run.
    """
    if stored.scope != jobs.RUN:
        return
    today = _of_today(session, stored)
    limits = limits_in_force(session, stored.machine_id)
    if stored.accepted and today:
        rows = compared(session, stored, baseline_runs=baseline_runs, longest=watching_rates.LOOKED_BACK)
        watching_rates.judge(session, rows, limits)
    found = comparison(session, stored, baseline_runs=baseline_runs)
    if found is None:
        return
    diagnosis = found.watch.found(found.observations, on_delay=lambda kind, element: delays(limits, kind, element)[0])
    statements = _statements(session, found, diagnosis, stored)
    diagnoses.keep(
        session,
        stored,
        baseline=[row.id for row in found.baseline],
        runs=max((len(cause.agreement) for cause in diagnosis.causes), default=0),
        causes=[one.evidence() for one in statements],
    )
    if not today:
        return
    baseline = [row.id for row in found.baseline]
    raised = {alert.id for one in statements if (alert := _raise(session, one, stored, limits, baseline)) is not None}
    for alert in alerts.open_alerts(session, stored.machine_id):
        if alert.rule in RULES and alert.id not in raised and _may_clear(alert, stored):
            _clear_if_gone(session, alert, found, statements, limits)


def _of_today(session: Session, stored: IdentificationRow) -> bool:
    """Whether a run shows the machine as it is: the newest of its kind, under the document and the baseline in force."""
    newest = machines.get(session, stored.machine_id).revision
    then, today = (baselines.in_force(session, stored.machine_id, at=moment) for moment in (stored.measured_at, now()))
    same_machine = stored.revision in machines.comparable(session, stored.machine_id, newest)
    return same_machine and then is today and identifications.is_newest(session, stored)


def comparison(session: Session, stored: IdentificationRow, *, baseline_runs: int) -> Comparison | None:
    """The newest runs up to an identification, accepted or not, beside their baseline.

    None while that is incomplete, where the run is part of it or covers other speeds, or where an older release identified:
    that says nothing of the channels.
    """
    machine = machines.document(session, stored.machine_id, stored.revision)
    rows = compared(session, stored, baseline_runs=baseline_runs, accepted=False, longest=LOOKED_BACK)
    channels = tuple(probe.id for probe in machine.probes)
    baseline = _said(rows.baseline, channels)
    if not len(baseline) == rows.wanted > 0:
        return None
    names = baseline[0][1].names
    complete = rows.baseline[-1].measured_at
    # What was refused while the baseline was gathered is not the newest of anything.
    later = [row for row in rows.after if row.accepted or row.measured_at > complete]
    after = [(row, said) for row, said in _said(later, channels) if said.names == names]
    if not after or after[-1][0].id != stored.id or any(said.names != names for _, said in baseline):
        return None
    follows = adjustment(
        [said.point for _, said in baseline], [row.conditions or {} for row, _ in baseline], machine.conditions
    )
    watch = Watch.over(machine, [_adjusted(said, row, follows) for row, said in baseline])
    observations = tuple(_adjusted(said, row, follows) for row, said in after)
    return Comparison(machine, tuple(row for row, _ in baseline), watch, tuple(row for row, _ in after), observations)


def _adjusted(said: Observation, row: IdentificationRow, follows: Adjustment) -> Observation:
    """What a run says of the machine under the baseline's mean operating conditions."""
    if not follows.conditions:
        return said
    return said.at(follows.adjusted(said.point, row.conditions or {}))


def _said(rows: Sequence[IdentificationRow], channels: tuple[str, ...]) -> list[tuple[IdentificationRow, Observation]]:
    return [(row, said) for row in rows if (said := identifications.observed(row, channels)) is not None]


def _statements(session: Session, found: Comparison, diagnosis: Diagnosis, stored: IdentificationRow) -> list[Statement]:
    amplitude = {probe.id: typical_amplitude(probe.id, found.watch.baseline) for probe in found.machine.probes}
    units = parameter_units(found.machine)
    statements = []
    for cause, runners_up in zip(diagnosis.causes, diagnosis.runners_up, strict=True):
        size = change_size(cause, found.watch.reference, amplitude=amplitude)
        since, first = _since(session, found, cause)
        force = None
        if cause.kind == "misalignment":
            force = derived.value(session, stored.id, f"{cause.element}.misalignment_force")
        statements.append(Statement(cause, runners_up, size, since, first, force, units))
    return statements


def _since(session: Session, found: Comparison, cause: Cause) -> tuple[int, int]:
    """When the first run that shows a cause was measured [ns], and that run's identification.

    Never later than its open alert says: against a change that has grown, the runs with which it began look like healthy ones.
    """
    began = found.after[found.watch.began(cause, found.observations)]
    known = alerts.open_alert(session, began.machine_id, rule=rule_of(cause), element=cause.element)
    if known is None or known.evidence.get("kind") != cause.kind:
        return began.measured_at, began.id
    said = from_datetime(datetime.fromisoformat(known.evidence["since"]))
    first = int(known.evidence["first_identification"])
    return min((began.measured_at, began.id), (said, first))


def _raise(
    session: Session, one: Statement, stored: IdentificationRow, limits: Limits, baseline: list[int]
) -> AlertRow | None:
    """Open an alert or bring it up to date, where a limit is reached. baseline: ids of what it was compared with."""
    rule, element = rule_of(one.cause), one.cause.element
    present = alerts.open_alert(session, stored.machine_id, rule=rule, element=element)
    held = None if present is None else Severity(present.severity)
    severity = cause_severity(limits, one.cause, one.size, force=one.force, present=held)
    if severity is None:
        return None
    finding = Finding(
        message=one.words(),
        evidence=one.evidence() | {"identification": stored.id, "run_kind": stored.run_kind, "baseline": baseline},
        identification_id=stored.id,
        measured_at=stored.measured_at,
        severity=severity,
        latching=rule not in DATA_RULES and limits.rule(rule, element).latching,
    )
    return alerting.raise_alert(session, stored.machine_id, rule=rule, element=element, finding=finding)


def cause_severity(
    limits: Limits, cause: Cause, size: ChangeSize, *, force: float | None, present: Severity | None
) -> Severity | None:
    """How severe a cause of a size is, with the force in the coupling [N] and the severity that its alert has so far."""
    rule = rule_of(cause)
    if rule in DATA_RULES or size.per_cent is None:
        return Severity.ALERT
    return severity_of(
        limits,
        rule,
        sigma=cause.distance,
        per_cent=size.per_cent,
        force=force,
        present=present,
        element=cause.element,
    )


def delays(limits: Limits, kind: str, element: str) -> tuple[int, int]:
    """How many runs in a row open and clear an alert."""
    rule = rule_of(kind)
    if rule in DATA_RULES:
        return DATA_DELAY, DATA_DELAY
    chosen = limits.rule(rule, element)
    return chosen.on_delay, chosen.off_delay


def _may_clear(alert: AlertRow, stored: IdentificationRow) -> bool:
    # A hot run-down may show what a cold run-up does not: only the kind of run that showed it can take it back.
    return alert.evidence.get("run_kind") == stored.run_kind


def _clear_if_gone(
    session: Session, alert: AlertRow, found: Comparison, statements: Sequence[Statement], limits: Limits
) -> None:
    kind = str(alert.evidence.get("kind", alert.rule))
    still = [one for one in statements if (one.cause.kind, one.cause.element) == (kind, alert.element)]
    off_delay = delays(limits, kind, alert.element)[1]
    # What is still seen, but below its limit with the hysteresis taken off, has returned as well.
    if still or found.watch.gone(found.observations, kind, alert.element, off_delay=off_delay):
        alerting.clear_alert(session, alert)
