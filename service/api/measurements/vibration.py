"""Serves the vibration at each probe: its newest values beside the machine's limits, and the trend at running speed."""

from typing import Annotated

import numpy as np
from fastapi import APIRouter, Query, Request

from estimator.arrays import Complexes, Floats
from estimator.machine.document import Machine
from estimator.machine.rules import SeverityZones
from estimator.phasors.near_speed import near_running_speed
from estimator.phasors.running_speed import speed_of_trend
from estimator.trends.acceptance_region import AcceptanceRegion, acceptance_region
from estimator.units import METRES, RADIANS, rad_per_s_to_rpm, rpm_to_rad_per_s
from service.api.conventions.dependencies import MachineId, Period, Reading
from service.api.conventions.problems import RESPONSES
from service.api.conventions.values import MICROMETRES
from service.api.measurements import vibration_schemas as schemas
from service.api.measurements.corrections import SlowRollQuery, chosen
from service.api.measurements.run_vectors import RunVectorCache, RunVectors
from service.security.requirement import VIEWER
from storage.clock import to_datetime
from storage.encoding.sample_blocks import Samples
from storage.machines import baselines, machines
from storage.measurements import runs, samples

router = APIRouter(prefix="/machines", tags=["measurements"], responses=RESPONSES, dependencies=[VIEWER])

NEWEST_SAMPLES = 25
"""Samples that are looked through for a good value of each channel."""
MOST_RUNS = 400


@router.get("/{machine_id}/vibration", operation_id="read_vibration")
def read_vibration(session: Reading, machine_id: MachineId, slow_roll: SlowRollQuery = "none") -> schemas.MachineVibration:
    """Read the newest good 1× of each probe, as measured or without slow-roll vectors, and the document's limits.

    2×, overall level and gap stand beside it where a source sends them.
    """
    row = machines.get(session, machine_id)
    machine = machines.document(session, machine_id, row.revision)
    held = samples.latest(
        session,
        machine_id,
        revision=row.revision,
        also=machines.revisions_with_same_channels(session, machine_id, row.revision),
        channels=len(machine.probes),
        count=NEWEST_SAMPLES,
    )
    version, vectors, left_out = chosen(session, machine, slow_roll)
    offset = np.zeros(held.phasor.shape, complex) if vectors is None else vectors.turned(held.direction.astype(float))
    first = np.where(held.usable, held.phasor - offset, complex(np.nan, np.nan))
    return schemas.MachineVibration(
        machine=machine_id,
        slow_roll_version=version,
        slow_roll_left_out=left_out,
        limits=_limits(machine),
        probes=[_newest(machine, i, held, first[:, i]) for i in range(len(machine.probes))],
    )


def _limits(machine: Machine) -> schemas.VibrationLimits:
    operation = machine.operation
    levels = operation.vibration_limit, operation.vibration_alert, operation.vibration_danger
    balanced, alert, danger = (None if level is None else level / MICROMETRES for level in levels)
    zones = operation.severity_zones
    return schemas.VibrationLimits(
        balanced_um_pp=balanced,
        alert_um_pp=alert,
        danger_um_pp=danger,
        severity_zones=None
        if zones is None
        else schemas.ZoneBoundaries(
            source=zones.source,
            a_b_um_pp=zones.a_b / MICROMETRES,
            b_c_um_pp=zones.b_c / MICROMETRES,
            c_d_um_pp=zones.c_d / MICROMETRES,
        ),
    )


def _newest(machine: Machine, place: int, held: Samples, first: Complexes) -> schemas.ProbeVibration:
    channel = machine.channels[place]
    good = np.flatnonzero(np.isfinite(first))
    if good.size == 0:
        return schemas.ProbeVibration(channel=channel)
    at = int(good[-1])
    running = machine.operation.running_rpm
    zones = machine.operation.severity_zones
    if running is None or not near_running_speed(held.speed, rpm_to_rad_per_s(running))[at]:
        zones = None
    overall = float(held.overall[at, place])
    return schemas.ProbeVibration(
        channel=channel,
        time=to_datetime(int(held.time[at])),
        speed_rpm=rad_per_s_to_rpm(float(held.speed[at])),
        first=_vector(complex(first[at])),
        second=_vector(complex(held.second[at, place])),
        overall_um_pp=_value(overall / MICROMETRES),
        zone=_zone(zones, overall),
        gap_um=_value(float(held.gap[at, place]) / METRES["um"]),
    )


def _zone(zones: SeverityZones | None, overall: float) -> schemas.Zone | None:
    """Return the zone of an overall level, 0-to-peak [m]; None without zones, and for NaN."""
    return None if zones is None or not np.isfinite(overall) else zones.zone(overall)


def _value(value: float) -> float | None:
    return value if np.isfinite(value) else None


def _vector(phasor: complex) -> schemas.VibrationVector | None:
    if not np.isfinite(phasor):
        return None
    lag = float(np.mod(-np.angle(phasor) / RADIANS["deg"], 360.0)) % 360.0
    return schemas.VibrationVector(amplitude_um_pp=abs(phasor) / MICROMETRES, phase_lag_deg=lag)


@router.get("/{machine_id}/vibration/trend", operation_id="read_vibration_trend")
def read_vibration_trend(
    request: Request,
    session: Reading,
    machine_id: MachineId,
    period: Period,
    slow_roll: SlowRollQuery = "none",
    limit: Annotated[int, Query(ge=1, le=MOST_RUNS, description="number of newest runs that are read")] = 200,
) -> schemas.VibrationTrend:
    """Read 1×, 2× and their ratio at running speed, run by run, with the acceptance region of each probe and kind of run.

    The regions are made of the first runs of the baseline in force, which are those that identifications are compared with.
    """
    machine = machines.document(session, machine_id)
    rows = runs.of_machine(session, machine_id, first=period.first, last=period.last, limit=limit)
    rows = [row for row in reversed(rows) if row.state == runs.CLOSED and row.released_at is None and row.speed_maximum]
    named = machine.operation.running_rpm
    version, vectors, left_out = chosen(session, machine, slow_roll)
    if named is None and not rows:
        return schemas.VibrationTrend(machine=machine_id, running_rpm=None, limits=_limits(machine), probes=[])
    speed = speed_of_trend(np.array([row.speed_maximum for row in rows])) if named is None else rpm_to_rad_per_s(named)
    kept: RunVectorCache = request.app.state.run_vectors
    found = kept.of_runs(session, machine, rows, running_speed=speed)
    begun = baselines.in_force(session, machine_id, at=runs.LAST_TIME)
    since = 0 if begun is None else begun.since
    directions = np.array([one.direction for one in found], dtype=float)
    offset = np.zeros((len(found), len(machine.probes)), complex) if vectors is None else vectors.turned(directions)
    return schemas.VibrationTrend(
        machine=machine_id,
        running_rpm=rad_per_s_to_rpm(speed),
        running_speed_named=named is not None,
        slow_roll_version=version,
        slow_roll_left_out=left_out,
        limits=_limits(machine),
        probes=[
            _trend(machine, found, i, offset[:, i], since=since, baseline_runs=request.app.state.baseline_runs)
            for i in range(len(machine.probes))
        ],
    )


def _trend(
    machine: Machine, found: list[RunVectors], place: int, offset: Complexes, *, since: int, baseline_runs: int
) -> schemas.ProbeTrend:
    first = np.array([one.first[place] for one in found], complex) - offset
    second = np.array([one.second[place] for one in found], complex)
    kinds = [one.kind for one in found]
    regions = {}
    for kind in dict.fromkeys(kinds):
        own = [i for i, one in enumerate(found) if one.kind == kind and one.ended_at >= since and np.isfinite(first[i])]
        region = acceptance_region(first[own[:baseline_runs]])
        if region is not None and len(own) >= baseline_runs:
            regions[kind] = region
    within = [
        bool(regions[kind].holds(complex(vector))) if kind in regions and np.isfinite(vector) else None
        for kind, vector in zip(kinds, first, strict=True)
    ]
    known = np.isfinite(first)
    overall = np.array([one.overall[place] for one in found], float)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.abs(second) / np.abs(first)
    return schemas.ProbeTrend(
        channel=machine.channels[place],
        run=[one.run for one in found],
        run_kind=kinds,
        measured_at=[to_datetime(one.ended_at) for one in found],
        speed_rpm=[rad_per_s_to_rpm(one.speed) for one in found],
        amplitude_um_pp=_column(np.abs(first) / MICROMETRES),
        phase_lag_deg=_column(np.where(known, _lag(first), np.nan)),
        amplitude_2x_um_pp=_column(np.abs(second) / MICROMETRES),
        phase_2x_lag_deg=_column(np.where(np.isfinite(second), _lag(second), np.nan)),
        second_over_first=_column(ratio),
        overall_um_pp=_column(overall / MICROMETRES),
        zone=[_zone(machine.operation.severity_zones, level) for level in overall.tolist()],
        gap_um=_column(np.array([one.gap[place] for one in found], float) / METRES["um"]),
        within=within,
        regions=[_region(kind, region, baseline_runs) for kind, region in regions.items()],
    )


def _lag(phasor: Complexes) -> Floats:
    return np.asarray(np.mod(-np.angle(phasor) / RADIANS["deg"], 360.0) % 360.0)


def _column(values: Floats) -> list[float | None]:
    return [_value(value) for value in values.tolist()]


def _region(kind: str, region: AcceptanceRegion, count: int) -> schemas.Region:
    return schemas.Region(
        run_kind=kind,
        runs=count,
        centre_real_um_pp=region.centre.real / MICROMETRES,
        centre_imaginary_um_pp=region.centre.imag / MICROMETRES,
        semi_major_um_pp=region.semi_major / MICROMETRES,
        semi_minor_um_pp=region.semi_minor / MICROMETRES,
        inclination_deg=region.inclination / RADIANS["deg"],
    )
