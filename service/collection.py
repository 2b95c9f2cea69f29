"""Run collection: new samples of a machine move its sweep state on; runs open and close with the samples they hold."""

import logging
import time
from dataclasses import asdict
from typing import Any

import numpy as np
from sqlalchemy.orm import Session

from estimator.machine import Machine
from estimator.segmentation import RunEnded, RunEvent, RunStarted, SweepLimits, SweepState, advance, finish
from storage import jobs, machines, runs, samples
from storage.blocks import Samples
from storage.tables import RunRow

logger = logging.getLogger(__name__)

ALIVE_PATIENCE = 10.0
"""A source that is connected is waited for this many times longer than one that is not."""
FEWEST_SAMPLES = 20
"""A run of fewer samples is not identified."""
SMALLEST_SPAN = 0.2
"""Nor is one that covers less than this part of the machine's speed range."""


class Collector:
    """Collects the runs of all machines. All it must remember is stored with the samples, in the same transaction."""

    def __init__(self) -> None:
        self._heard: dict[str, float] = {}

    def seen(self, session: Session, machine_id: str) -> int:
        """Time of the newest sample that run collection knows of [ns]; what comes later but lies before belongs to no run."""
        stored = runs.collector_state(session, machine_id)
        return 0 if stored is None else int(stored["seen"])

    def feed(self, session: Session, machine: Machine, revision: int, new: Samples) -> None:
        """Take newly stored samples of one machine, by time. Those before the newest one known belong to no run."""
        self._heard[machine.id] = time.monotonic()
        stored = runs.collector_state(session, machine.id) or _fresh(revision)
        if stored["revision"] != revision:
            self._end(session, machine.id, stored, reason="the machine's document was revised")
            stored = _fresh(revision) | {"seen": stored["seen"]}
        limits = SweepLimits.of(machine.speed_range)
        state, seen = SweepState(**stored["sweep"]), stored["seen"]
        for moment, speed, direction in zip(new.time.tolist(), new.speed.tolist(), new.direction.tolist(), strict=True):
            if moment <= seen:
                continue
            seen = moment
            state, events = advance(state, limits, time=moment, speed=speed, direction=direction)
            for event in events:
                self._record(session, machine, revision, direction, event)
        runs.save_collector_state(session, machine.id, _stored(state, revision, seen))

    def close_silent(self, session: Session, machine: Machine, *, silence_s: float, alive: bool) -> None:
        """Close the open run of a machine that has sent nothing for so long; a source that is alive may take its time."""
        heard = self._heard.setdefault(machine.id, time.monotonic())
        if time.monotonic() - heard < silence_s * (ALIVE_PATIENCE if alive else 1.0):
            return
        stored = runs.collector_state(session, machine.id)
        if stored is not None and stored["sweep"]["sweep"] != 0:
            self._end(session, machine.id, stored, reason="the source fell silent")
            fresh = _fresh(stored["revision"]) | {"seen": stored["seen"]}
            runs.save_collector_state(session, machine.id, fresh)

    def _end(self, session: Session, machine_id: str, stored: dict[str, Any], *, reason: str) -> None:
        _, events = finish(SweepState(**stored["sweep"]), reason=reason)
        row = runs.current(session, machine_id)
        for event in events:
            if isinstance(event, RunEnded) and row is not None:
                _close(session, row, event)

    def _record(self, session: Session, machine: Machine, revision: int, direction: int, event: RunEvent) -> None:
        if isinstance(event, RunStarted):
            runs.open_run(session, machine.id, revision=revision, kind=event.kind, direction=direction, time_first=event.time)
            logger.info("%s: a %s has begun", machine.id, event.kind)
            return
        row = runs.current(session, machine.id)
        if row is not None:
            _close(session, row, event)


def _close(session: Session, row: RunRow, event: RunEnded) -> None:
    machine = machines.document(session, row.machine_id, row.revision)
    held = samples.between(
        session,
        row.machine_id,
        revision=row.revision,
        channels=len(machine.probes),
        first=event.start,
        last=event.time,
    )
    held = _once(held.pick(held.direction == row.direction))
    weakness = _weakness(machine, held)
    runs.close(
        row,
        samples=held,
        state=runs.DISCARDED if weakness else runs.CLOSED,
        reason=f"{event.reason}; {weakness}" if weakness else event.reason,
    )
    logger.info("%s: %s %s with %d samples: %s", row.machine_id, row.kind, row.state, len(held), row.reason)
    if not weakness:
        jobs.ask(session, row.machine_id, scope=jobs.RUN, run_ids=[row.id])


def _once(held: Samples) -> Samples:
    """One sample per instant: a source that began anew, or a second one, may have told of the same instants again."""
    _, first = np.unique(held.time, return_index=True)
    return held.pick(first)


def _weakness(machine: Machine, held: Samples) -> str | None:
    """Why a run is not worth an identification, if it is not."""
    if len(held) < FEWEST_SAMPLES:
        return f"not identified: {len(held)} samples, {FEWEST_SAMPLES} are needed"
    limits = SweepLimits.of(machine.speed_range)
    covered = float(held.speed.max() - held.speed.min())
    if covered < limits.span(SMALLEST_SPAN):
        percent = 100 * covered / limits.span(1.0)
        return f"not identified: it covers {percent:.0f} % of the speed range, {100 * SMALLEST_SPAN:.0f} % are needed"
    return None


def _fresh(revision: int) -> dict[str, Any]:
    return _stored(SweepState(), revision, 0)


def _stored(state: SweepState, revision: int, seen: int) -> dict[str, Any]:
    return {"sweep": asdict(state), "revision": revision, "seen": seen}
