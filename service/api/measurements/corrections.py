"""Reads samples of a run as measured, or without slow-roll vectors."""

from collections.abc import Collection
from typing import Annotated, cast

from fastapi import Query
from msgspec.structs import replace
from sqlalchemy.orm import Session

from estimator.machine.document import Machine
from estimator.phasors.slow_roll import SlowRoll
from service.api.conventions.problems import Unsuitable
from service.api.conventions.units import Units
from service.api.measurements import rendering, schemas
from service.identification import job_options
from storage.clock import now
from storage.encoding.sample_blocks import Samples
from storage.machines import machines, slow_roll
from storage.measurements import runs, samples

SlowRollQuery = Annotated[
    str,
    Query(pattern=r"^(none|in_force|[0-9]{1,9})$", description="vectors to subtract: `none`, `in_force` or a version"),
]


MOST_VALUES = 1_500_000
"""Most values of an answer: each takes some 50 bytes while it is made, and several answers are made at a time."""


def run_samples(session: Session, run_id: int) -> tuple[Machine, Samples]:
    """Return a run's samples and the document that they were stored under; of an open run, those collected so far."""
    row = runs.get(session, run_id)
    machine = machines.document(session, row.machine_id, row.revision)
    held = runs.samples(session, run_id)
    if held is None:
        channels = len(machine.probes)
        held = samples.between(
            session, row.machine_id, revision=row.revision, channels=channels, first=row.time_first, last=now()
        )
    return machine, held


def chosen(session: Session, machine: Machine, choice: str) -> tuple[int | None, SlowRoll | None, dict[str, str]]:
    """Return the chosen version, its vectors for a machine's channels, and the reasons of channels without one.

    Raises SlowRollUnknown.
    """
    number = int(choice) if choice.isdecimal() else cast(job_options.SlowRollChoice, choice)
    version = job_options.chosen_version(session, machine.id, number)
    if version is None:
        return None, None, {}
    row = slow_roll.get(session, machine.id, version)
    return version, slow_roll.vectors(row, machine), slow_roll.doubtful(row, machine)


def corrected_phasors(
    session: Session,
    machine: Machine,
    held: Samples,
    choice: str,
    units: Units | None,
    include: Collection[schemas.PhasorExtra] = (),
) -> schemas.Phasors:
    """Return samples without the chosen vectors, and in further units where requested.

    Raises SlowRollUnknown, and Unsuitable for more values than an answer may have.
    """
    most = most_samples(machine, units, include)
    if len(held) > most:
        raise Unsuitable(
            f"so many samples of {len(machine.channels)} channels are more than the {MOST_VALUES} values that an answer "
            f"may have: ask for {most} samples at a time, with `limit`, from and to, at GET /api/v1/machines/<id>/samples"
        )
    version, vectors, left_out = chosen(session, machine, choice)
    if vectors is not None:
        held = replace(held, phasor=held.phasor - vectors.turned(held.direction.astype(float)))
    answer = rendering.phasors(machine, held, include)
    in_units = None if units is None else rendering.phasors_in_units(held, units, include)
    return answer.model_copy(update={"slow_roll_version": version, "slow_roll_left_out": left_out, "in_units": in_units})


def most_samples(machine: Machine, units: Units | None, include: Collection[schemas.PhasorExtra]) -> int:
    """Return the number of samples that an answer may have."""
    for_each = (1 if units is None else 2) * (2 + len(set(include)) + ("2x" in include)) * len(machine.channels)
    return MOST_VALUES // for_each
