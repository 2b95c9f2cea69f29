"""Caches the rows of the overview: only machines that sent samples or changed are rendered again."""

import threading
from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from typing import Any

import msgspec
from sqlalchemy.orm import Session

from estimator.machine.rules import SpeedRange
from estimator.units import rad_per_s_to_rpm
from service.alerts.lifecycle import Severity
from service.api.conventions.values import MICROMETRES, time_or_none
from service.api.machines.machine_state import progress, why_without_run
from service.runs.collection_state import CollectionState
from storage.clock import to_datetime
from storage.database.change_counts import Changes
from storage.database.engine import Database
from storage.machines import fleet
from storage.machines.fleet import AlertGlance, IdentificationGlance, ListedMachine, MachineGlance, RunGlance
from storage.measurements.runs import OPEN

LABELS = [(severity, severity.label) for severity in Severity]

OverviewRow = dict[str, Any]


@dataclass(frozen=True)
class _CachedRow:
    """A row as JSON with its inputs. standing: state of run collection, as JSON; None before samples."""

    glance: MachineGlance
    standing: str | None
    row: msgspec.Raw


class Overview:
    """Rows of the overview of all machines."""

    def __init__(self, database: Database) -> None:
        self._changes = Changes(database)
        self._glances: tuple[Hashable, list[MachineGlance]] | None = None
        self._rows: dict[str, _CachedRow] = {}
        self._lock = threading.Lock()

    def rows(self, session: Session, machines: Sequence[ListedMachine], *, since: int) -> list[msgspec.Raw]:
        """Return one row per machine, as JSON; since: events are counted from then on [ns]."""
        glances = self._cached_glances(session, machines, since)
        standings = fleet.collectors(session)
        with self._lock:
            return [self._row(one, standings.get(one.machine.id)) for one in glances]

    def _cached_glances(self, session: Session, machines: Sequence[ListedMachine], since: int) -> list[MachineGlance]:
        mark = self._changes.mark(fleet.TABLES)
        asked = (mark, since, tuple(one.id for one in machines))
        kept = self._glances
        if mark is not None and kept is not None and kept[0] == asked:
            return kept[1]
        found = fleet.glances(session, machines, since=since)
        self._glances = asked, found
        return found

    def _row(self, glance: MachineGlance, standing: str | None) -> msgspec.Raw:
        kept = self._rows.get(glance.machine.id)
        if kept is None or kept.standing != standing or (kept.glance is not glance and kept.glance != glance):
            known = None if standing is None else CollectionState.restored(msgspec.json.decode(standing))
            kept = _CachedRow(glance, standing, msgspec.Raw(msgspec.json.encode(_row(glance, known))))
            self._rows[glance.machine.id] = kept
        return kept.row


def _row(one: MachineGlance, standing: CollectionState | None) -> OverviewRow:
    # Encoded without a model: a thousand of them would be looked at field by field.
    readings = None if standing is None else standing.operating.sweep.readings
    known = readings is not None and readings.last_time is not None
    return {
        "id": one.machine.id,
        "plant": one.machine.plant,
        "name": one.machine.name,
        "revision": one.machine.revision,
        "state": "unknown" if standing is None else standing.operating.mode,
        "state_since": time_or_none(standing.operating.since or None) if standing is not None else None,
        "speed_rpm": rad_per_s_to_rpm(readings.last_speed) if known and readings is not None else None,
        "newest_sample_at": None if standing is None else to_datetime(standing.seen),
        "open_run": _open_run(one, standing),
        "last_run": _last_run(one.last_run),
        "last_identification": _last_identification(one.last_identification),
        "open_alerts": {label: one.open_alerts.get(severity, 0) for severity, label in LABELS},
        "unacknowledged": one.unacknowledged,
        "first_alert": _first_alert(one.first_alert),
        "outside_speed_range": _without_run(one, standing),
        "vibration_beyond_danger": _beyond_danger(one, standing),
        "failed_job": None if one.failed_job is None else {"id": one.failed_job.id, "error": one.failed_job.error},
        "happened": one.since,
    }


def _without_run(one: MachineGlance, standing: CollectionState | None) -> str | None:
    minimum, maximum = one.machine.minimum_rpm, one.machine.maximum_rpm
    if standing is None or minimum is None or maximum is None:
        return None
    limits = SpeedRange(minimum_rpm=minimum, maximum_rpm=maximum)
    return why_without_run(limits, standing, has_runs=one.last_run is not None)


def _beyond_danger(one: MachineGlance, standing: CollectionState | None) -> OverviewRow | None:
    level = None if standing is None else standing.danger.told
    if standing is None or level is None or standing.revision != one.machine.revision:
        return None
    return {
        "channel": level.channel,
        "amplitude_um_pp": level.amplitude / MICROMETRES,
        "danger_um_pp": level.limit / MICROMETRES,
        "speed_rpm": rad_per_s_to_rpm(level.speed),
        "first_at": to_datetime(level.first),
        "last_at": to_datetime(level.last),
    }


def _open_run(one: MachineGlance, standing: CollectionState | None) -> OverviewRow | None:
    run = one.last_run
    if standing is None or run is None or run.state != OPEN:
        return None
    minimum, maximum = one.machine.minimum_rpm, one.machine.maximum_rpm
    if minimum is None or maximum is None:
        return None
    part = progress(run.kind, standing, minimum_rpm=minimum, maximum_rpm=maximum)
    return {"id": run.id, "kind": run.kind, "started_at": to_datetime(run.time_first), "progress": part}


def _first_alert(alert: AlertGlance | None) -> OverviewRow | None:
    if alert is None:
        return None
    named = {"rule": alert.rule, "element": alert.element, "state": alert.state}
    return {"id": alert.id, "severity": Severity(alert.severity).label} | named


def _last_run(run: RunGlance | None) -> OverviewRow | None:
    if run is None:
        return None
    times = {"started_at": to_datetime(run.time_first), "ended_at": time_or_none(run.time_last)}
    return {"id": run.id, "kind": run.kind, "state": run.state} | times


def _last_identification(last: IdentificationGlance | None) -> OverviewRow | None:
    if last is None:
        return None
    outcome = {"accepted": last.accepted, "verdict": last.verdict}
    return {"id": last.id, "measured_at": to_datetime(last.measured_at)} | outcome
