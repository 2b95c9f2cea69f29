"""Reads the contents of a report on a machine over a period."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from sqlalchemy.orm import Session

from service.advice.advice import FAULTS_OF_CONTENT
from service.advice.alert_advice import alert_advice, alert_event, alert_message
from service.advice.site_texts import SiteTexts
from service.alerts.event_message import AlertEvent
from service.balancing.open_causes import SomethingElseWrong, require_nothing_else
from service.identification.stored_model import NoModel, identified, used_runs
from service.monitoring.comparison import compared
from service.reports.contents import (
    PeriodCounts,
    ReportContents,
    ReportedAlert,
    ReportedBalancing,
    ReportedFit,
    ReportedNote,
)
from service.reports.period import ReportPeriod
from service.reports.trend_reading import read_trends, reported_names
from service.wording.language import Language
from service.wording.shown_units import USUAL_UNITS, ShownUnits
from storage.alerts import alerts
from storage.alerts.alerts import ListedAlert
from storage.clock import now, to_datetime
from storage.findings import diagnoses, identifications
from storage.machines import balancings, machines, timeline
from storage.measurements import runs
from storage.tables.findings import IdentificationRow

MOST_ALERTS, MOST_EVENTS, MOST_NOTES, MOST_BALANCINGS, MOST_COUNTED = 500, 200, 200, 50, 20_000
"""Most entries of each kind in a report; more is said to be left out."""
MOST_OPEN = 10_000
"""Open alerts that are read; there is one of each rule and element at most."""
MOST_RUNS = 4
"""Runs of an identification that are drawn."""


def read_contents(
    session: Session,
    machine_id: str,
    period: ReportPeriod,
    *,
    texts: SiteTexts,
    baseline_runs: int,
    units: ShownUnits = USUAL_UNITS,
) -> ReportContents:
    """Read a report's contents. Its sentences tell lengths in the units' own, as its plots do. Raises MachineUnknown."""
    texts = texts.in_language(replace(texts.language, length_unit=units.length))
    row = machines.get(session, machine_id)
    told = list(_alerts(session, machine_id, period, texts))
    events = sorted((event for _, own in told for event in own), key=lambda one: (one.at, one.id), reverse=True)
    notes = timeline.of_machine(session, machine_id, first=period.first, last=period.last, limit=MOST_NOTES + 1)
    newest = identifications.newest_of_single_run(session, machine_id, last=period.last)
    open_elements = [one.last.element for one, _ in told if one.is_open]
    names = () if newest is None else reported_names(session, newest, open_elements)
    translate = texts.language.translate
    left_out = [translate("report.older_events", count=len(events) - MOST_EVENTS)] if len(events) > MOST_EVENTS else []
    left_out += [translate("report.older_alerts", count=MOST_ALERTS)] if len(told) >= MOST_ALERTS else []
    left_out += [translate("report.older_notes")] if len(notes) > MOST_NOTES else []
    return ReportContents(
        machine=machines.document(session, machine_id, row.revision),
        plant=row.plant,
        first=to_datetime(period.first),
        last=to_datetime(period.last),
        made_at=to_datetime(now()),
        counts=_counts(session, machine_id, period),
        alerts=tuple(one for one, _ in told),
        events=tuple(events[:MOST_EVENTS]),
        notes=tuple(ReportedNote(to_datetime(one.at), one.kind, one.by, one.text) for one in notes[:MOST_NOTES]),
        trends=tuple(read_trends(session, machine_id, names, period, baseline_runs=baseline_runs, units=units)),
        balancings=tuple(_balancings(session, machine_id, period)),
        fit=None if newest is None else _fit(session, newest, baseline_runs),
        not_to_balance=_reason_to_wait(session, machine_id, texts.language),
        left_out=tuple(left_out),
        language=texts.language,
        units=units,
    )


def _alerts(
    session: Session, machine_id: str, period: ReportPeriod, texts: SiteTexts
) -> Iterator[tuple[ReportedAlert, list[AlertEvent]]]:
    """Yield the alerts that were open at some time of the period, each with its events in the period."""
    newest = alerts.find(session, machine_id=machine_id, only_open=False, limit=MOST_ALERTS)
    still_open = alerts.find(session, machine_id=machine_id, only_open=True, limit=MOST_OPEN)
    for row in {one.id: one for one in (*newest, *still_open)}.values():
        if row.closed_at is not None and row.closed_at < period.first:
            continue
        history = alerts.history(session, row.id)
        until = [one for one in history if one.at <= period.last]
        if not until:
            continue  # it opened later
        last = alert_event(until[-1], texts)
        if len(until) == len(history) and row.measured_at <= period.last:
            last = _as_of_newest_run(row, last, texts)
        closed_at = None if row.closed_at is None or row.closed_at > period.last else to_datetime(row.closed_at)
        reported = ReportedAlert(until[-1].severity, last, closed_at, is_open=closed_at is None)
        yield reported, [alert_event(one, texts) for one in until if one.at >= period.first]


def _as_of_newest_run(row: ListedAlert, last: AlertEvent, texts: SiteTexts) -> AlertEvent:
    """Return an alert's newest event with the figures of the newest run, which may have come after it."""
    if last.advice is None or row.closed_at is not None:
        return last
    try:
        advice = alert_advice(row, texts)
        return last.model_copy(update={"advice": advice, "message": alert_message(row, advice, texts)})
    except FAULTS_OF_CONTENT:
        return last  # of which a text can be made


def _counts(session: Session, machine_id: str, period: ReportPeriod) -> PeriodCounts:
    own = runs.of_machine(session, machine_id, first=period.first, last=period.last, limit=MOST_COUNTED)
    newest = own[:1] or runs.of_machine(session, machine_id, last=period.last, limit=1)
    found = identifications.accepted_flags(session, machine_id, first=period.first, last=period.last)
    return PeriodCounts(
        runs=len(own),
        identifications=len(found),
        accepted=sum(found),
        turned_until=to_datetime(newest[0].time_last or newest[0].time_first) if newest else None,
    )


def _balancings(session: Session, machine_id: str, period: ReportPeriod) -> Iterator[ReportedBalancing]:
    for row in balancings.of_machine(session, machine_id, limit=MOST_BALANCINGS):
        if period.first <= row.updated_at <= period.last:
            yield ReportedBalancing(to_datetime(row.updated_at), row.by, row.state, row.comment)


def _reason_to_wait(session: Session, machine_id: str, language: Language) -> str | None:
    try:
        require_nothing_else(session, machine_id, language)
    except SomethingElseWrong as error:
        return str(error)
    return None


def _fit(session: Session, newest: IdentificationRow, baseline_runs: int) -> ReportedFit | None:
    """Read an identification with its runs and its baseline; None for one of an older release, which kept no model."""
    try:
        one = identified(session, newest.id)
        found = compared(session, newest, baseline_runs=baseline_runs)
        rows: Sequence[IdentificationRow] = () if found.missing is not None else found.baseline
        baseline = tuple(identified(session, row.id) for row in rows)
    except NoModel:
        return None
    return ReportedFit(
        measured_at=to_datetime(newest.measured_at),
        one=one,
        runs=tuple(used_runs(session, one, one.run_ids[-MOST_RUNS:])),
        baseline=baseline,
        reference=tuple(used_runs(session, baseline[0], baseline[0].run_ids[-1:])) if baseline else (),
        missing=found.missing or "",
        causes=diagnoses.named_causes(diagnoses.of_identification(session, newest.id)),
    )
