"""Repository of slow-roll vectors: immutable versions, and which of them is in force.

Samples and runs keep the measured values. A vector belongs to a probe as it was when the vector was made: when a document
places the channel elsewhere on the shaft, at another angle or with another sensitivity, the vector is doubtful and is left
out.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from sqlalchemy import select
from sqlalchemy.orm import Session

from estimator.errors import Missing
from estimator.machine.document import Machine
from estimator.machine.parts import Probe
from estimator.phasors.slow_roll import SlowRoll
from storage.clock import now
from storage.machines import machines
from storage.paging import Keys, ordered
from storage.tables.machines import SlowRollRow

GIVEN, CAPTURED = "given", "captured"
"""Origin of vectors: entered by a person, or captured from stored samples."""

_OF_THE_PROBE = ("shaft", "station", "angle_deg", "sensitivity")


class SlowRollUnknown(Missing):
    """Raised when no slow-roll vectors have this version."""

    subject = "slow-roll vectors"

    @property
    def detail(self) -> str:
        """Return a message that names the missing vectors."""
        return f"no {self.subject}: {self.args[0]}"


@dataclass(frozen=True)
class Provenance:
    """Origin of vectors. Speeds [rad/s] and times [ns] are those of the samples they were captured from, else None."""

    origin: str
    comment: str = ""
    speed_minimum: float | None = None
    speed_maximum: float | None = None
    time_first: int | None = None
    time_last: int | None = None


def add(
    session: Session,
    machine: Machine,
    slow_roll: SlowRoll,
    provenance: Provenance,
    *,
    reasons: Mapping[str, str] | None = None,
) -> SlowRollRow:
    """Store vectors of a machine's channels as its next version. reasons: why channels have none."""
    vectors = {}
    for column, probe in enumerate(machine.probes):
        if slow_roll.known[column]:
            vector = complex(slow_roll.vector[column])
            vectors[probe.id] = {
                "real": vector.real,
                "imaginary": vector.imag,
                "standard_error": float(slow_roll.standard_error[column]),
                "probe": _probe(probe),
            }
        elif reasons and probe.id in reasons:
            vectors[probe.id] = {"refused": reasons[probe.id]}
    newest = versions(session, machine.id, limit=1)
    row = SlowRollRow(
        machine_id=machine.id,
        version=newest[0].version + 1 if newest else 1,
        created_at=now(),
        origin=provenance.origin,
        direction=slow_roll.direction,
        vectors=vectors,
        speed_minimum=provenance.speed_minimum,
        speed_maximum=provenance.speed_maximum,
        time_first=provenance.time_first,
        time_last=provenance.time_last,
        comment=provenance.comment,
    )
    session.add(row)
    session.flush()
    return row


def get(session: Session, machine_id: str, version: int) -> SlowRollRow:
    """Return a version of a machine's vectors; raise SlowRollUnknown when there is none."""
    row = session.get(SlowRollRow, (machine_id, version))
    if row is None:
        raise SlowRollUnknown(f"version {version} of machine '{machine_id}'")
    return row


def versions(session: Session, machine_id: str, *, limit: int, after: Keys | None = None) -> Sequence[SlowRollRow]:
    """Return the versions, newest first. after: the last version of the page before."""
    query = ordered(select(SlowRollRow).where(SlowRollRow.machine_id == machine_id), (SlowRollRow.version,), after)
    return session.scalars(query.limit(limit)).all()


def put_in_force(session: Session, machine_id: str, version: int | None) -> None:
    """Set the version that identifications subtract from now on; None: none. Raises MachineUnknown, SlowRollUnknown."""
    row = machines.get(session, machine_id)
    if version is not None:
        get(session, machine_id, version)
    row.slow_roll_version = version


def vectors(row: SlowRollRow, machine: Machine) -> SlowRoll:
    """Return the vectors that are valid for a document's channels."""
    left_out = doubtful(row, machine)
    vector = np.full(len(machine.probes), complex(np.nan, np.nan))
    error = np.full(len(machine.probes), np.nan)
    for column, channel in enumerate(machine.channels):
        if channel not in left_out:
            held = row.vectors[channel]
            vector[column], error[column] = complex(held["real"], held["imaginary"]), held["standard_error"]
    return SlowRoll(row.direction, vector, error)


def doubtful(row: SlowRollRow, machine: Machine) -> dict[str, str]:
    """Return the channels of a document without a valid vector, and why."""
    found = {}
    for probe in machine.probes:
        held = row.vectors.get(probe.id)
        if held is None:
            found[probe.id] = "it has no vector"
        elif "refused" in held:
            found[probe.id] = held["refused"]
        else:
            is_now = _probe(probe)
            changed = [name for name in _OF_THE_PROBE if held["probe"][name] != is_now[name]]
            if changed:
                found[probe.id] = "; ".join(f"its {name} was {held['probe'][name]}, not {is_now[name]}" for name in changed)
    return found


def _probe(probe: Probe) -> dict[str, str | float | None]:
    return {name: getattr(probe, name) for name in _OF_THE_PROBE}
