"""Repository of runs and of the state of each machine's run collection."""

import struct
import zlib
from collections.abc import Collection, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec import structs
from numpy.typing import NDArray
from sqlalchemy import func, select
from sqlalchemy.orm import Session, undefer

from estimator.errors import Gone, Missing
from estimator.runs.coverage import Coverage
from estimator.runs.dwells import DWELLS
from estimator.runs.speed_bins import ROLLING
from storage.clock import latest, to_datetime
from storage.encoding.sample_blocks import DamagedBlock, Samples, decode, encode
from storage.paging import Keys, between, ordered
from storage.tables.measurements import CollectorRow, MachineStateRow, RunRow

if TYPE_CHECKING:
    from estimator.phasors.quality import Quality

_FLAGS = struct.Struct("<HII")  # format, samples, channels; then the flags, compressed
_FLAGS_FORMAT = 1

OPEN, ENDED, CLOSED, DISCARDED = "open", "ended", "closed", "discarded"
"""States of a run; an ended one is over, but its samples are still to be collected."""
LEFT_OUT = "late_samples_left_out"
"""Field of `runs.coverage`: number of samples that came too late even for a rebuilt run."""
CROSSED = "critical_speeds_rpm"
"""Field of `runs.coverage`: critical speeds of the document's model within the run's speed range [r/min]."""
LAST_TIME = 2**63 - 1
NO_SWEEPS = (ROLLING, DWELLS)
"""Kinds of runs that are no run-up or run-down, and stand beside these."""


class RunUnknown(Missing):
    """Raised when no run has this id."""

    subject = "run"


class SamplesReleased(Gone):
    """A run's samples were deleted according to the retention settings."""


def open_run(session: Session, machine_id: str, *, revision: int, kind: str, direction: int, time_first: int) -> RunRow:
    """Record that a run has begun; when another one begins at the same time, it begins a nanosecond later."""
    row = RunRow(
        machine_id=machine_id,
        revision=revision,
        kind=kind,
        direction=direction,
        state=OPEN,
        reason=None,
        time_first=free_start(session, machine_id, time_first),
        time_last=None,
        speed_minimum=None,
        speed_maximum=None,
        count=None,
        data=None,
    )
    session.add(row)
    session.flush()
    return row


def free_start(session: Session, machine_id: str, time: int) -> int:
    """Return the first time [ns] from the given one on at which no other run of the machine begins."""
    while session.scalars(select(RunRow.id).where(RunRow.machine_id == machine_id, RunRow.time_first == time)).first():
        time += 1
    return time


def open_run_of(session: Session, machine_id: str) -> RunRow | None:
    """Return the open run of a machine; None when there is none."""
    query = select(RunRow).where(RunRow.machine_id == machine_id, RunRow.state == OPEN)
    return session.scalars(query).one_or_none()


def unfinished(session: Session, machine_id: str) -> Sequence[RunRow]:
    """Return the runs of a machine that are open, or whose samples are still to be collected."""
    return session.scalars(select(RunRow).where(RunRow.machine_id == machine_id, RunRow.state.in_((OPEN, ENDED)))).all()


def end(row: RunRow, *, first: int, last: int, reason: str) -> None:
    """Record that a sweep is over and lasted from first to last [ns]; its samples are still to be collected."""
    row.state, row.reason, row.time_last = ENDED, reason, last
    row.extent = {"first": first, "last": last}


def end_rolling(row: RunRow, *, times: Sequence[int], reason: str) -> None:
    """Record that a rolling collection is over and consists of the samples at these times [ns], ascending."""
    row.state, row.reason, row.time_last = ENDED, reason, times[-1]
    row.extent = {"times": list(times)}


def ended(session: Session) -> Sequence[tuple[int, str]]:
    """Return id and machine of every run whose samples are still to be collected, in the order of their beginning."""
    query = select(RunRow.id, RunRow.machine_id).where(RunRow.state == ENDED).order_by(RunRow.time_first, RunRow.id)
    return [(number, machine_id) for number, machine_id in session.execute(query)]


def extent(session: Session, run_id: int) -> dict[str, Any]:
    """Return the extent of an ended run, see `end`. Raises RunUnknown."""
    row = session.get(RunRow, run_id, options=[undefer(RunRow.extent)])
    if row is None:
        raise RunUnknown(run_id)
    return row.extent or {"first": row.time_first, "last": row.time_last or row.time_first}


def close(
    row: RunRow,
    *,
    samples: Samples,
    state: str,
    reason: str,
    coverage: Coverage | None = None,
    data: bytes | None = None,
) -> None:
    """Freeze a run with its samples; `state` is CLOSED, or DISCARDED when the run is not worth an identification.

    data: the encoded samples, when they were encoded before.
    """
    row.state = state
    row.reason = reason
    row.extent = None
    row.count = len(samples)
    row.data, row.released_at = data or encode(samples), None  # made anew, it has its samples again
    row.coverage = None if coverage is None else asdict(coverage) | {CROSSED: None, LEFT_OUT: 0}
    row.quality = row.flags = None  # of other samples, if there is any
    if len(samples):
        row.time_last = max(int(samples.time[-1]), row.time_first)
        row.speed_minimum = float(np.min(samples.speed))
        row.speed_maximum = float(np.max(samples.speed))


def store_crossed_speeds(session: Session, run_id: int, critical_speeds_rpm: Sequence[float]) -> None:
    """Store the critical speeds of the document's model that a run has crossed [r/min]. Raises RunUnknown."""
    row = get(session, run_id)
    if row.coverage is not None:
        row.coverage = row.coverage | {CROSSED: list(critical_speeds_rpm)}


def add_left_out_samples(row: RunRow, count: int) -> None:
    """Count samples that came after a run could no longer be rebuilt; they are not part of it."""
    if row.coverage is not None:  # it is null in a run without samples
        row.coverage = row.coverage | {LEFT_OUT: row.coverage.get(LEFT_OUT, 0) + count}


def overlapping(session: Session, machine_id: str, *, revision: int, first: int, last: int) -> Sequence[RunRow]:
    """Return the sweeps of one revision that overlap the time from first to last [ns], open ones included, oldest first."""
    query = (
        select(RunRow)
        .where(RunRow.machine_id == machine_id, RunRow.revision == revision, RunRow.kind.not_in(NO_SWEEPS))
        .where(RunRow.time_first <= last, func.coalesce(RunRow.time_last, LAST_TIME) >= first)
        .order_by(RunRow.time_first)
    )
    return session.scalars(query).all()


def end_before(session: Session, row: RunRow, time: int) -> int:
    """Return when the last other sweep of a run's machine ended that was over by a time [ns]; 0 when there is none."""
    query = select(func.max(RunRow.time_last)).where(
        RunRow.machine_id == row.machine_id, RunRow.kind.not_in(NO_SWEEPS), RunRow.id != row.id
    )
    return session.scalar(query.where(RunRow.time_last <= time)) or 0


def get(session: Session, run_id: int) -> RunRow:
    """Return a run by id; raise RunUnknown when there is none."""
    row = session.get(RunRow, run_id)
    if row is None:
        raise RunUnknown(run_id)
    return row


def is_dwells(row: RunRow) -> bool:
    """Return whether a run is of dwells at constant speed, through which no sweep goes."""
    return row.kind == DWELLS


def samples(session: Session, run_id: int) -> Samples | None:
    """Return the samples of a closed run; None while it is open. Raises RunUnknown, SamplesReleased, DamagedBlock."""
    row = session.get(RunRow, run_id, options=[undefer(RunRow.data)])
    if row is None:
        raise RunUnknown(run_id)
    require_kept(row)
    return None if row.data is None else read(run_id, row.data)


def read(run_id: int, data: bytes) -> Samples:
    """Decode the stored samples of a run. Raises DamagedBlock."""
    try:
        return decode(data)
    except DamagedBlock as error:
        raise DamagedBlock(f"the samples of run {run_id} cannot be read: {error}") from error


def store_quality(session: Session, run_id: int, quality: "Quality") -> None:
    """Store the quality of a run: a summary, and each phasor's flags. Raises RunUnknown."""
    row = get(session, run_id)
    row.quality = {
        "points": int(quality.flags.size),
        "usable": int(np.count_nonzero(quality.usable)),
        "counts": quality.counts,
        "findings": list(quality.findings),
        "channels": list(quality.channels),
        "noise": {channel: _finite(structs.asdict(noise)) for channel, noise in quality.noise.items()},
    }
    row.flags = _FLAGS.pack(_FLAGS_FORMAT, *quality.flags.shape) + zlib.compress(quality.flags.astype("<u2").tobytes(), 1)


def flags(session: Session, run_id: int) -> NDArray[np.uint16] | None:
    """Return the flags (S, m) of a run's phasors, see `estimator.phasors.quality.Flag`; None before they were assessed.

    Raises RunUnknown, SamplesReleased, DamagedBlock.
    """
    row = session.get(RunRow, run_id, options=[undefer(RunRow.flags)])
    if row is None:
        raise RunUnknown(run_id)
    require_kept(row)
    if row.flags is None:
        return None
    try:
        version, samples_held, channels = _FLAGS.unpack_from(row.flags)
        if version != _FLAGS_FORMAT:
            raise DamagedBlock(f"flags of format {version}, not {_FLAGS_FORMAT}")
        found = np.frombuffer(zlib.decompress(row.flags[_FLAGS.size :]), "<u2").reshape(samples_held, channels)
    except (struct.error, zlib.error, ValueError) as error:
        raise DamagedBlock(f"the flags of run {run_id} cannot be read: {error}") from error
    return found.astype(np.uint16)


def require_kept(row: RunRow) -> None:
    """Raise SamplesReleased where the samples of a run were deleted."""
    if row.released_at is not None:
        moment = to_datetime(row.released_at)
        raise SamplesReleased(f"the samples of run {row.id} were deleted on {moment:%Y-%m-%d}, as the retention of runs says")


def previous_run(session: Session, row: RunRow) -> RunRow | None:
    """Return the closed run before another of the same machine, revision, kind and sense of rotation; None without one."""
    query = (
        select(RunRow)
        .where(RunRow.machine_id == row.machine_id, RunRow.revision == row.revision, RunRow.state == CLOSED)
        .where(RunRow.kind == row.kind, RunRow.direction == row.direction, RunRow.time_first < row.time_first)
        .order_by(RunRow.time_first.desc())
        .limit(1)
    )
    return session.scalars(query).first()


def _finite(values: dict[str, float]) -> dict[str, float | None]:
    return {name: value if np.isfinite(value) else None for name, value in values.items()}


def of_machine(
    session: Session,
    machine_id: str,
    *,
    first: int | None = None,
    last: int | None = None,
    limit: int | None = None,
    after: Keys | None = None,
) -> Sequence[RunRow]:
    """Return the runs of a machine that began between two times [ns], newest first.

    after: (beginning, id) of the last one of the page before.
    """
    query = ordered(select(RunRow).where(RunRow.machine_id == machine_id), (RunRow.time_first, RunRow.id), after)
    query = between(query, RunRow.time_first, first, last)
    return session.scalars(query.limit(limit)).all()


def newest_closed(session: Session, machine_id: str, *, revision: int, limit: int) -> Sequence[RunRow]:
    """Return the newest closed sweeps of one revision whose samples are still stored, newest first."""
    query = (
        select(RunRow)
        .where(RunRow.machine_id == machine_id, RunRow.revision == revision, RunRow.state == CLOSED)
        .where(RunRow.kind.not_in(NO_SWEEPS), RunRow.released_at.is_(None))
        .order_by(RunRow.time_first.desc())
        .limit(limit)
    )
    return session.scalars(query).all()


def collectors(session: Session, machine_ids: Collection[str]) -> Sequence[CollectorRow]:
    """Return the stored states of run collection by machine; machines without one are left out."""
    return session.scalars(select(CollectorRow).where(CollectorRow.machine_id.in_(machine_ids))).all()


def collector_state(session: Session, machine_id: str) -> dict[str, Any] | None:
    """Return the state of the machine's run collection when its newest samples were stored; None before any."""
    row = session.get(CollectorRow, machine_id)
    return None if row is None else row.state


def save_collector_state(session: Session, machine_id: str, state: dict[str, Any]) -> None:
    """Store the state of the machine's run collection."""
    row = session.get(CollectorRow, machine_id)
    if row is None:
        session.add(CollectorRow(machine_id=machine_id, state=state))
    else:
        row.state = state


def add_state(session: Session, machine_id: str, *, since: int, mode: str, speed: float | None) -> None:
    """Store the operating mode of a machine from a time on [ns]. speed: at that time, when known [rad/s]."""
    session.add(MachineStateRow(machine_id=machine_id, since=since, mode=mode, speed=speed))


def states(
    session: Session,
    machine_id: str,
    *,
    first: int | None = None,
    last: int | None = None,
    limit: int | None = None,
    after: Keys | None = None,
) -> Sequence[MachineStateRow]:
    """Return the states of a machine that began between two times [ns], newest first.

    after: (beginning, id) of the last one of the page before. Without `last`, states in the future are left out: a clock that
    was ahead must not hide the present.
    """
    last = latest() if last is None else last
    query = select(MachineStateRow).where(MachineStateRow.machine_id == machine_id)
    query = between(query, MachineStateRow.since, first, last)
    return session.scalars(ordered(query, (MachineStateRow.since, MachineStateRow.id), after).limit(limit)).all()
