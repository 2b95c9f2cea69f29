"""A run ends: the samples that belong to it, whether they are worth an identification, what they cover."""

import logging

import numpy as np
from sqlalchemy.orm import Session

from estimator.capture import captured, thinned
from estimator.coverage import coverage
from estimator.machine import Machine
from estimator.segmentation import SweepLimits
from estimator.units import rpm_to_rad_per_s
from service.own_faults import own_fault
from storage import jobs, quarantine, runs, samples
from storage.blocks import Samples
from storage.tables import RunRow

logger = logging.getLogger(__name__)

FEWEST_SAMPLES = 20
"""A run of fewer samples is not identified."""
SMALLEST_SPAN = 0.2
"""Nor is one that covers less than this part of the machine's speed range."""
LARGEST_READ = 100_000
"""Samples of a run that are looked at; of more than these only every second, third, … is."""


def close_sweep(session: Session, machine: Machine, row: RunRow, *, first: int, last: int, reason: str) -> None:
    """Close a run-up or run-down that lasted from first to last [ns], and ask for its identification."""
    close_with(session, machine, row, sweep_samples(session, machine, row, first=first, last=last), reason=reason)


def close_with(session: Session, machine: Machine, row: RunRow, held: Samples, *, reason: str) -> None:
    """Close a run with these samples, by time, and ask for its identification; a run made anew is identified anew."""
    weakness = _weakness(machine, held)
    duration = float(held.time[-1] - held.time[0]) / 1e9 if len(held) else 0.0
    runs.close(
        row,
        samples=held,
        state=runs.DISCARDED if weakness else runs.CLOSED,
        reason=f"{reason}; {weakness}" if weakness else reason,
        coverage=coverage(machine, held.measurement(), duration_s=duration) if len(held) else None,
    )
    logger.info("%s: %s %s with %d samples: %s", row.machine_id, row.kind, row.state, len(held), row.reason)
    if not weakness:
        options = {"reopened": row.times_reopened} if row.times_reopened else None
        jobs.ask(session, row.machine_id, scope=jobs.RUN, run_ids=[row.id], options=options)


def sweep_samples(session: Session, machine: Machine, row: RunRow, *, first: int, last: int) -> Samples:
    """What a sweep from first to last [ns] captures, by time: in the row's sense of rotation and the speed range.

    Samples shortly before it belong to it too, as far as they do not belong to the run before.
    """
    begin = max(first - round(1e9 * machine.collection.pre_trigger_s), runs.end_before(session, machine.id, first) + 1)
    damaged: list[str] = []
    found = samples.between(
        session,
        machine.id,
        revision=row.revision,
        channels=len(machine.probes),
        first=min(begin, first),
        last=last,
        largest=LARGEST_READ,
        damaged=damaged,
    )
    tell_damaged(session, row, damaged)
    inside = (found.direction == row.direction) & (found.speed >= rpm_to_rad_per_s(machine.speed_range.minimum_rpm))
    return _captured(machine, _once(found.pick(inside)))


def tell_damaged(session: Session, row: RunRow, damaged: list[str]) -> None:
    """Blocks that a run is without, though their samples were stored once."""
    of, known = f"run {row.id}", dict.fromkeys(damaged)
    if known:
        told = [own_fault("damaged_block", of=of, machine_id=row.machine_id, detail=words) for words in known]
        quarantine.add(session, told)


def _captured(machine: Machine, held: Samples) -> Samples:
    """By change of speed and time where the document asks for it; thinned where there are far too many."""
    rules = machine.collection
    kept = held.pick(
        captured(
            time=held.time,
            speed=held.speed,
            delta_speed=None if rules.delta_rpm is None else rpm_to_rad_per_s(rules.delta_rpm),
            delta_time=None if rules.delta_s is None else round(1e9 * rules.delta_s),
        )
    )
    return kept.pick(thinned(time=kept.time, speed=kept.speed))


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
