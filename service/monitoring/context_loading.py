"""Loading the input of an assessment: the machine's state, and the context that a worker assesses."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime

from sqlalchemy.orm import Session

from estimator.machine.document import Machine
from estimator.machine.parameter_description import describe
from estimator.trends.parameter_vector import Point
from service.alerts.lifecycle import Severity
from service.monitoring.assessment.alignment_steps import has_step
from service.monitoring.assessment.context import (
    WEEK,
    AssessedRun,
    AssessmentBasis,
    AssessmentContext,
    BaselineHistory,
    ComparedRuns,
    ComparedValue,
    MeanConditions,
    StoredNumbers,
)
from service.monitoring.comparison import ComparisonTerms, baseline_of, compared_with, terms_of
from service.monitoring.limits_in_force import limits_of
from service.monitoring.rules.drift_rule import RATE_OF_CHANGE
from service.monitoring.rules.finding_catalogue import DIAGNOSIS_RULES, is_finding
from service.monitoring.rules.finding_rules import FINDING_RULES
from storage.alerts import alerts
from storage.clock import from_datetime
from storage.findings import derived, identifications, jobs
from storage.machines import limits, machines
from storage.tables.alerting import AlertRow
from storage.tables.findings import DerivedRow, IdentificationRow
from storage.tables.machines import LimitsRow

LOOKED_BACK = 60
"""Newest identifications of single runs that are assessed: enough to find when a change began, and for delays of up to 20."""
COUPLED_LOADS = ("misalignment_force", "misalignment_moment")
"""Derived quantities of a coupling that a misalignment is told with."""
SECOND_ORDER = "second_amplitude"
"""Derived quantity of a probe that may decide between explanations."""


@dataclass(frozen=True)
class MonitoringState:
    """State of a machine at an identification of one of its runs.

    terms: conditions under which the run is compared. current: whether the run shows the machine's present state: the newest
    of its kind, under the document and the baseline now in force.
    """

    terms: ComparisonTerms
    limits: LimitsRow | None
    current: bool
    open_alerts: Sequence[AlertRow]

    @property
    def basis(self) -> AssessmentBasis:
        """Return the baseline that a person began, and the limits that a person set, in force now."""
        began, chosen = self.terms.began, self.limits
        return AssessmentBasis(None if began is None else began.id, None if chosen is None else chosen.version)


def load_state(session: Session, stored: IdentificationRow) -> MonitoringState:
    """Read the state of an identification's machine. Raises MachineUnknown."""
    terms = terms_of(session, stored)
    return MonitoringState(
        terms=terms,
        limits=limits.in_force(session, stored.machine_id),
        current=_is_current(session, terms),
        open_alerts=alerts.open_alerts(session, stored.machine_id),
    )


def load_context(session: Session, stored: IdentificationRow, *, baseline_runs: int) -> AssessmentContext | None:
    """Read the context of an assessment after an identification was stored; return None for one that no trend follows."""
    if stored.scope != jobs.RUN:
        return None
    machine = machines.document(session, stored.machine_id, stored.revision)
    state = load_state(session, stored)
    terms = state.terms
    baseline, wanted = baseline_of(session, stored.machine_id, terms.like, terms.began, baseline_runs=baseline_runs)
    before, after = _runs(session, terms, baseline, wanted)
    compared_ids = [one.id for one in before]
    return AssessmentContext(
        machine=machine,
        limits=limits_of(state.limits),
        basis=state.basis,
        baseline=before,
        after=after,
        open_causes=tuple(
            (kind, one.element)
            for one in state.open_alerts
            if one.rule in DIAGNOSIS_RULES and is_finding(kind := diagnosed_kind(one))
        ),
        history=_history(session, machine, state, baseline, wanted),
        open_rates={one.element: Severity(one.severity) for one in state.open_alerts if one.rule == RATE_OF_CHANGE.name},
        compared=_compared_runs(session, stored, baseline, compared_ids),
        loads=tuple(_coupled_loads(session, machine, stored, compared_ids)),
        second_orders=tuple(_second_orders(session, machine, stored, compared_ids)),
        numbers=_stored_numbers(session, stored),
        open_steps={
            one.element: from_datetime(datetime.fromisoformat(one.evidence["since"]))
            for one in state.open_alerts
            if has_step(one.evidence)
        },
    )


def diagnosed_kind(alert: AlertRow) -> str:
    """Return the kind of cause that an alert of a diagnosis reports."""
    return str(alert.evidence.get("kind", alert.rule))


def _is_current(session: Session, terms: ComparisonTerms) -> bool:
    stored = terms.identification
    if stored.revision not in terms.revisions.comparable(machines.get(session, stored.machine_id).revision):
        return False
    return terms.today is terms.began and identifications.is_newest(session, stored)


def _runs(
    session: Session, terms: ComparisonTerms, baseline: Sequence[IdentificationRow], wanted: int
) -> tuple[tuple[AssessedRun, ...], tuple[AssessedRun, ...]]:
    """Read the baseline and the newest runs up to an identification, accepted or not.

    Returns none while the baseline is incomplete, when the run is part of it or covers other speeds, or when an older release
    identified, which stored nothing about single channels.
    """
    stored = terms.identification
    rows = compared_with(session, terms, baseline, wanted, accepted=False, longest=LOOKED_BACK)
    before = _assessed_runs(rows.baseline)
    if not len(before) == rows.wanted > 0:
        return (), ()
    complete = rows.baseline[-1].measured_at
    # Runs refused while the baseline was still incomplete do not count as newest ones.
    after = _assessed_runs([row for row in rows.after if row.accepted or row.measured_at > complete])
    return (before, after) if after and after[-1].id == stored.id else ((), ())


def _assessed_runs(rows: Sequence[IdentificationRow]) -> tuple[AssessedRun, ...]:
    fitted = [(row, fit) for row in rows if (fit := identifications.fit(row)) is not None]
    return tuple(AssessedRun(row.id, row.measured_at, row.conditions or {}, fit) for row, fit in fitted)


def _history(
    session: Session, machine: Machine, state: MonitoringState, baseline: Sequence[IdentificationRow], wanted: int
) -> BaselineHistory | None:
    """Read the input of rates of change; return None when the run is refused, or does not show the machine's present state."""
    if not state.terms.identification.accepted or not state.current:
        return None
    rows = compared_with(session, state.terms, baseline, wanted, longest=LOOKED_BACK)
    if rows.missing is not None:
        return None
    return BaselineHistory(
        conditions=machine.conditions,
        baseline=_points(session, rows.baseline) if machine.conditions else [],
        times=[row.measured_at / WEEK for row in rows.after],
        after=_points(session, rows.after),
    )


def _compared_runs(
    session: Session, stored: IdentificationRow, baseline: Sequence[IdentificationRow], ids: Sequence[int]
) -> ComparedRuns | None:
    """Read what the table of deviations of an identification is made of. ids: ids of the baseline, none while it is
    incomplete."""
    if not ids or not stored.accepted:
        return None
    (newest,) = _points(session, [stored])
    return ComparedRuns(_points(session, [row for row in baseline if row.id in ids]), newest)


def _coupled_loads(
    session: Session, machine: Machine, stored: IdentificationRow, ids: Sequence[int]
) -> Iterator[ComparedValue]:
    """Yield the loads in the couplings that an identification and all those of its baseline have."""
    elements = {f"coupling.{one.id}.{load}": f"coupling.{one.id}" for one in machine.couplings for load in COUPLED_LOADS}
    yield from _compared_values(session, elements, stored, ids)


def _second_orders(
    session: Session, machine: Machine, stored: IdentificationRow, ids: Sequence[int]
) -> Iterator[ComparedValue]:
    """Yield the amplitudes of the 2× that an identification and all those of its baseline have."""
    elements = {f"probe.{channel}.{SECOND_ORDER}": f"probe.{channel}" for channel in machine.channels}
    yield from _compared_values(session, elements, stored, ids)


def _stored_numbers(session: Session, stored: IdentificationRow) -> StoredNumbers:
    """Read the forces of an identification that findings have, and which parameters it does not determine."""
    forces = {one.force for one in FINDING_RULES if one.force is not None}
    values = derived.of_identification(session, stored.id)
    return StoredNumbers(
        forces={row.name: row.value for row in values if describe(row.name).quantity in forces},
        not_estimable=tuple(one.parameter for one in identifications.estimates(session, stored.id) if one.value is None),
    )


def _compared_values(
    session: Session, elements: Mapping[str, str], stored: IdentificationRow, ids: Sequence[int]
) -> Iterator[ComparedValue]:
    """Yield the derived quantities that all have. elements: each quantity's element by name; ids: baseline's ids."""
    if not ids or not elements:
        return
    rows = derived.several(session, [stored.id, *ids], elements)
    for name, element in elements.items():
        now = rows.get((stored.id, name))
        before = [row for number in ids if (row := rows.get((number, name))) is not None]
        known = [(row.value, _half_width(row)) for row in before if row.value is not None]
        if now is not None and now.value is not None and len(known) == len(ids):
            yield ComparedValue(name, element, now.unit, now.value, known)


def _half_width(row: DerivedRow) -> float | None:
    return None if row.lower is None or row.upper is None else (row.upper - row.lower) / 2.0


def _points(session: Session, rows: Sequence[IdentificationRow]) -> list[tuple[Point, MeanConditions]]:
    known = identifications.points(session, rows)
    return [(known[row.id], row.conditions or {}) for row in rows if row.id in known]
