"""Overview of all machines in few queries: their last run and identification, open alerts, and counts of events since a
time."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from sqlalchemy import ColumnElement, ScalarSelect, Text, case, cast, func, select
from sqlalchemy.orm import Session

from storage.clock import latest
from storage.database.readable_rows import readable_rows
from storage.tables.alerting import AlertEventRow, AlertRow
from storage.tables.findings import DONE, FAILED, QUARANTINED, IdentificationRow, JobRow
from storage.tables.machines import MachineRow, RevisionRow, TimelineRow
from storage.tables.measurements import CollectorRow, QuarantineRow, RunRow


@dataclass(frozen=True)
class RunGlance:
    """A run in the overview. Times in ns since 1970; time_last: None while it is open."""

    id: int
    kind: str
    state: str
    time_first: int
    time_last: int | None


@dataclass(frozen=True)
class IdentificationGlance:
    """An identification in the overview."""

    id: int
    measured_at: int
    accepted: bool
    verdict: str


@dataclass(frozen=True)
class AlertGlance:
    """An open alert in the overview."""

    id: int
    severity: int
    rule: str
    element: str
    state: str


@dataclass(frozen=True)
class FailedJobGlance:
    """A failed identification in the overview; none of its machine has succeeded since."""

    id: int
    error: str | None


@dataclass(frozen=True)
class ListedMachine:
    """A machine in a list. minimum_rpm, maximum_rpm: its speed range; None where its document is damaged."""

    id: str
    plant: str
    name: str
    revision: int
    created_at: int
    minimum_rpm: float | None
    maximum_rpm: float | None


@dataclass(frozen=True)
class MachineGlance:
    """The overview of one machine."""

    machine: ListedMachine
    last_run: RunGlance | None
    last_identification: IdentificationGlance | None
    open_alerts: dict[int, int]
    """Open alerts by severity."""
    unacknowledged: int
    first_alert: AlertGlance | None
    """The one that should be looked at first."""
    failed_job: FailedJobGlance | None
    since: dict[str, int]
    """Number of events by kind since the time asked for."""


TABLES = ("machines", "machine_revisions", "runs", "identifications", "alerts", "alert_events", "timeline")
"""Tables from which the overview is read; of quarantine and jobs beside them, one kept from before may be a minute old."""
UNACKNOWLEDGED = ("unacknowledged", "returned", "latched_unacknowledged")


def stamp(session: Session) -> tuple[int | None, ...]:
    """Return a stamp that stays equal as long as no machine was created or revised."""
    query = select(func.count(), func.sum(MachineRow.revision), func.max(MachineRow.created_at)).select_from(MachineRow)
    return tuple(session.execute(query).one())


def list_all(session: Session) -> list[ListedMachine]:
    """Return all machines by id, reading only the listed parts of their documents.

    A machine whose document is damaged is listed without name and speed range.
    """
    limits = RevisionRow.document["speed_range"]
    query = select(
        MachineRow.id,
        MachineRow.plant,
        RevisionRow.document["name"].as_string(),
        MachineRow.revision,
        MachineRow.created_at,
        limits["minimum_rpm"].as_float(),
        limits["maximum_rpm"].as_float(),
    )
    query = query.join(RevisionRow, _in_force()).order_by(MachineRow.id)
    bare = select(MachineRow.id, MachineRow.plant, MachineRow.revision, MachineRow.created_at).order_by(MachineRow.id)
    every = session.execute(bare).all()
    named = {row[0]: row for row in readable_rows(session, query, RevisionRow.machine_id, [row.id for row in every])}
    return [
        ListedMachine(*named[row.id])
        if row.id in named
        else ListedMachine(row.id, row.plant, "", row.revision, row.created_at, None, None)
        for row in every
    ]


def glances(session: Session, machines: Sequence[ListedMachine], *, since: int) -> list[MachineGlance]:
    """Return the overview of some machines, with the number of events since a time [ns]."""
    query = select(
        MachineRow.id,
        _newest(RunRow.id, RunRow.machine_id, RunRow.time_first),
        _newest(IdentificationRow.id, IdentificationRow.machine_id, IdentificationRow.measured_at),
        _last_job(FAILED, QUARANTINED),
        _last_job(DONE),
    )
    rows = {row[0]: row for row in session.execute(query.where(MachineRow.id.in_([one.id for one in machines])))}
    run = RunRow.id, RunRow.kind, RunRow.state, RunRow.time_first, RunRow.time_last
    runs = {one[0]: RunGlance(*one) for one in _by_ids(session, run, [row[1] for row in rows.values()])}
    identification = (
        IdentificationRow.id,
        IdentificationRow.measured_at,
        IdentificationRow.accepted,
        IdentificationRow.verdict,
    )
    found = _by_ids(session, identification, [row[2] for row in rows.values()])
    identifications = {one[0]: IdentificationGlance(*one) for one in found}
    unmended = [row[3] for row in rows.values() if row[3] is not None and row[3] > (row[4] or 0)]
    failed = {one[0]: FailedJobGlance(*one) for one in _by_ids(session, (JobRow.id, JobRow.error), unmended)}
    severities = _open_by_severity(session)
    waiting = _unacknowledged(session)
    first = _first_alerts(session)
    happened = _event_counts_since(session, since, [one.id for one in machines])
    return [
        MachineGlance(
            machine=one,
            last_run=runs.get(rows[one.id][1]),
            last_identification=identifications.get(rows[one.id][2]),
            open_alerts=severities.get(one.id, {}),
            unacknowledged=waiting.get(one.id, 0),
            first_alert=first.get(one.id),
            failed_job=failed.get(rows[one.id][3]),
            since={kind: counts.get(one.id, 0) for kind, counts in happened.items()},
        )
        for one in machines
        if one.id in rows
    ]


def collectors(session: Session) -> dict[str, str]:
    """Return the state of each machine's run collection as JSON text, without those that are damaged.

    Some of a thousand change with every sample block.
    """
    query = select(CollectorRow.machine_id, cast(CollectorRow.state, Text))
    ids = session.scalars(select(MachineRow.id)).all()
    return {machine_id: state for machine_id, state in readable_rows(session, query, CollectorRow.machine_id, ids)}  # noqa: C416


def _in_force() -> ColumnElement[bool]:
    return (RevisionRow.machine_id == MachineRow.id) & (RevisionRow.revision == MachineRow.revision)


def _newest(number: Any, machine_id: Any, time: Any) -> ScalarSelect[Any]:
    """Return a query for the id of a machine's newest row not in the future, from the index over machine and time."""
    return (
        select(number)
        .where(machine_id == MachineRow.id, time <= latest())
        .order_by(time.desc(), number.desc())
        .limit(1)
        .scalar_subquery()
    )


def _last_job(*states: str) -> ScalarSelect[Any]:
    """Return a query for the id of a machine's last job in one of some states, from the index over both."""
    return select(func.max(JobRow.id)).where(JobRow.machine_id == MachineRow.id, JobRow.state.in_(states)).scalar_subquery()


def _by_ids(session: Session, columns: tuple[Any, ...], ids: list[int | None]) -> Sequence[Any]:
    return session.execute(select(*columns).where(columns[0].in_([one for one in ids if one is not None]))).all()


def _open_by_severity(session: Session) -> dict[str, dict[int, int]]:
    query = select(AlertRow.machine_id, AlertRow.severity, func.count()).where(AlertRow.closed_at.is_(None))
    found: dict[str, dict[int, int]] = {}
    for machine_id, severity, count in session.execute(query.group_by(AlertRow.machine_id, AlertRow.severity)):
        found.setdefault(machine_id, {})[severity] = count
    return found


def _unacknowledged(session: Session) -> dict[str, int]:
    query = select(AlertRow.machine_id, func.count()).where(AlertRow.closed_at.is_(None), AlertRow.state.in_(UNACKNOWLEDGED))
    return dict(session.execute(query.group_by(AlertRow.machine_id)).all())


def _first_alerts(session: Session) -> dict[str, AlertGlance]:
    """Return of each machine's open alerts the first to look at: one that waits for a person, the worst, the newest."""
    waits = case((AlertRow.state.in_(UNACKNOWLEDGED), 0), else_=1)
    columns = AlertRow.machine_id, AlertRow.id, AlertRow.severity, AlertRow.rule, AlertRow.element, AlertRow.state
    query = select(*columns).where(AlertRow.closed_at.is_(None))
    found: dict[str, AlertGlance] = {}
    for row in session.execute(query.order_by(waits, AlertRow.severity.desc(), AlertRow.id.desc())):
        found.setdefault(row.machine_id, AlertGlance(row.id, row.severity, row.rule, row.element, row.state))
    return found


def _event_counts_since(session: Session, since: int, ids: Sequence[str]) -> dict[str, dict[str, int]]:
    """Return counts by kind and machine, without those of machines whose rows are damaged."""
    kinds: dict[str, tuple[Any, Any]] = {
        "runs": (RunRow.machine_id, RunRow.time_first),
        "identifications": (IdentificationRow.machine_id, IdentificationRow.computed_at),
        "alert_events": (AlertEventRow.machine_id, AlertEventRow.at),
        "revisions": (RevisionRow.machine_id, RevisionRow.created_at),
        "timeline": (TimelineRow.machine_id, TimelineRow.created_at),
        "refused": (QuarantineRow.machine_id, QuarantineRow.received_at),
    }
    return {
        kind: dict(tuple(row) for row in readable_rows(session, _by_machine(machine_id, time >= since), machine_id, ids))
        for kind, (machine_id, time) in kinds.items()
    }


def _by_machine(machine_id: Any, wanted: ColumnElement[bool]) -> Any:
    # Not grouped by the column itself: SQLite would walk its index, and with it years of wide rows, to count those of a day.
    group = machine_id.concat("")
    return select(group, func.count()).where(wanted).group_by(group)
