"""The samples that a run consists of, and whether they suffice for an identification. Reads only, and may take its time."""

from dataclasses import dataclass

import numpy as np
from sqlalchemy.orm import Session

from estimator.machine.document import Machine
from estimator.runs.coverage import Coverage, coverage
from estimator.runs.sample_selection import select_samples, thinned
from estimator.runs.segmentation import SweepLimits
from estimator.units import rpm_to_rad_per_s
from storage.encoding.sample_blocks import Samples, encode
from storage.machines import machines
from storage.measurements import runs, samples
from storage.tables.measurements import RunRow

FEWEST_SAMPLES = 20
"""Smallest number of samples of a run that is identified."""
SMALLEST_SPAN = 0.2
"""Smallest part of the machine's speed range that an identified run covers."""
LARGEST_READ = 1_600_000
"""Phasors of a run that are read, 100,000 samples of 16 channels; of more only every second, third, … sample is."""


@dataclass(frozen=True)
class RunContent:
    """The contents of an ended run. data: the encoded samples. weakness: why it does not suffice for an identification, if so.

    coverage: None without samples. damaged: faults of blocks that are left out.
    """

    samples: Samples
    data: bytes
    weakness: str | None
    coverage: Coverage | None
    damaged: list[str]


def largest_read(channels: int) -> int:
    """Return the number of samples of `channels` channels that are read together."""
    return max(1, LARGEST_READ // channels)


def gather(session: Session, row: RunRow) -> RunContent:
    """Return the samples of an ended run, by time."""
    machine = machines.document(session, row.machine_id, row.revision)
    extent = runs.extent(session, row.id)
    damaged: list[str] = []
    if "times" in extent:
        held = samples.at(
            session,
            row.machine_id,
            revision=row.revision,
            channels=len(machine.probes),
            times=extent["times"],
            damaged=damaged,
        )
    else:
        held = _sweep(session, machine, row, first=extent["first"], last=extent["last"], damaged=damaged)
    duration = float(held.time[-1] - held.time[0]) / 1e9 if len(held) else 0.0
    return RunContent(
        held,
        encode(held),
        _weakness(machine, held),
        coverage(machine, held.measurement(), duration_s=duration) if len(held) else None,
        damaged,
    )


def _sweep(session: Session, machine: Machine, row: RunRow, *, first: int, last: int, damaged: list[str]) -> Samples:
    """Return the samples of a sweep from first to last [ns], by time, in the row's sense of rotation and the speed range.

    Samples shortly before it belong to it too, unless they belong to the run before.
    """
    begin = max(first - round(1e9 * machine.collection.pre_trigger_s), runs.end_before(session, row, first) + 1)
    found = samples.between(
        session,
        row.machine_id,
        revision=row.revision,
        channels=len(machine.probes),
        first=min(begin, first),
        last=last,
        largest=largest_read(len(machine.probes)),
        damaged=damaged,
    )
    inside = (found.direction == row.direction) & (found.speed >= rpm_to_rad_per_s(machine.speed_range.minimum_rpm))
    return _captured(machine, _unique_times(found.pick(inside)))


def _captured(machine: Machine, held: Samples) -> Samples:
    """Return the samples selected by change of speed and time, if the document asks for it; thinned when there are far too
    many."""
    rules = machine.collection
    kept = held.pick(
        select_samples(
            time=held.time,
            speed=held.speed,
            delta_speed=None if rules.delta_rpm is None else rpm_to_rad_per_s(rules.delta_rpm),
            delta_time=None if rules.delta_s is None else round(1e9 * rules.delta_s),
        )
    )
    return kept.pick(thinned(time=kept.time, speed=kept.speed))


def _unique_times(held: Samples) -> Samples:
    """Return one sample per time: a restarted source, or a second one, may have sent the same times again."""
    _, first = np.unique(held.time, return_index=True)
    return held.pick(first)


def _weakness(machine: Machine, held: Samples) -> str | None:
    """Return why a run does not suffice for an identification; None when it does."""
    if len(held) < FEWEST_SAMPLES:
        return f"not identified: {len(held)} samples, {FEWEST_SAMPLES} are needed"
    limits = SweepLimits.of(machine.speed_range)
    covered = float(held.speed.max() - held.speed.min())
    if covered < limits.span(SMALLEST_SPAN):
        percent = 100 * covered / limits.span(1.0)
        return f"not identified: it covers {percent:.0f} % of the speed range, {100 * SMALLEST_SPAN:.0f} % are needed"
    return None
