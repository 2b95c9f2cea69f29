"""Runs of dwells at constant speed, which somebody names by their time: no sweep is there, that would begin and end by itself.

They are for calibrations and balancings, and are identified on request only, beside trends and baselines.
"""

from dataclasses import dataclass

import numpy as np
from sqlalchemy.orm import Session

from estimator.errors import Invalid
from estimator.machine.document import Machine
from estimator.runs.coverage import Coverage, coverage
from estimator.runs.dwells import DWELLS, dwelling
from estimator.runs.sample_selection import thinned
from estimator.units import rpm_to_rad_per_s
from service.runs.run_samples import largest_read
from storage.encoding.sample_blocks import Samples
from storage.machines import machines
from storage.measurements import runs, samples
from storage.tables.measurements import RunRow

LARGEST_COUNT = 200
"""Number of samples to which the dwells of a longer run are thinned: a fit takes all of them, and more say little."""
REASON = "identified on request only: dwells at constant speed are for calibrations and balancings"


class NoDwells(Invalid):
    """Raised when no run of dwells can be made of the samples of a time."""


@dataclass(frozen=True)
class Dwells:
    """Samples at constant speed of a machine, measured under a revision of its document or one that describes the same."""

    machine: Machine
    revision: int
    samples: Samples


def read_dwells(session: Session, machine_id: str, *, first: int, last: int) -> Dwells:
    """Return the samples at constant speed from first to last [ns], within the speed range.

    Raises MachineUnknown, NoDwells.
    """
    revision = machines.get(session, machine_id).revision
    machine = machines.document(session, machine_id, revision)
    channels = len(machine.probes)
    held = samples.between(
        session,
        machine_id,
        revision=revision,
        also=machines.revisions_with_same_channels(session, machine_id, revision),
        channels=channels,
        first=first,
        last=last,
        largest=largest_read(channels),
    )
    held = held.pick(np.unique(held.time, return_index=True)[1])
    limits = machine.speed_range
    inside = (held.speed >= rpm_to_rad_per_s(limits.minimum_rpm)) & (held.speed <= rpm_to_rad_per_s(limits.maximum_rpm))
    if not inside.any():
        why = f"all {len(held)} are outside" if len(held) else "none is stored at all"
        raise NoDwells(
            f"machine '{machine_id}' has no samples in that time within its speed range of {limits.minimum_rpm:g} to "
            f"{limits.maximum_rpm:g} r/min: {why}"
        )
    held = held.pick(inside)
    if np.any(held.direction != held.direction[0]):
        raise NoDwells(f"machine '{machine_id}' turned both ways in that time: a run has one sense of rotation")
    held = held.pick(dwelling(held.speed))
    return Dwells(machine, revision, held.pick(thinned(time=held.time, speed=held.speed, count=LARGEST_COUNT)))


def add_dwells(session: Session, found: Dwells, *, by: str) -> RunRow:
    """Store samples as a run of dwells that somebody asked for."""
    held = found.samples
    row = runs.open_run(
        session,
        found.machine.id,
        revision=found.revision,
        kind=DWELLS,
        direction=int(held.direction[0]),
        time_first=int(held.time[0]),
    )
    runs.close(row, samples=held, state=runs.DISCARDED, reason=f"made by {by}; {REASON}", coverage=_coverage(found))
    return row


def _coverage(found: Dwells) -> Coverage:
    held = found.samples
    return coverage(found.machine, held.measurement(), duration_s=float(held.time[-1] - held.time[0]) / 1e9)
