"""Restoring a model from a stored identification: its machine, its values, and the runs that it was made from."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from sqlalchemy.orm import Session

from estimator.arrays import Floats
from estimator.diagnosis.open_channels import estimate_beside
from estimator.errors import Conflict
from estimator.fit.omitted_errors.open_errors import beside_its_errors
from estimator.fit.validation.channel_sensitivity import ChannelEffects
from estimator.machine.document import Machine
from estimator.machine.rules import Noise
from estimator.machine.under_conditions import under_conditions
from estimator.phasors.measurement import Measurement
from estimator.phasors.quality import EXCLUDING
from estimator.phasors.slow_roll import SlowRoll, corrected
from estimator.updated_model.model import UpdatedModel, model_at
from storage.findings import identifications
from storage.machines import machines, slow_roll
from storage.measurements import runs
from storage.measurements.runs import RunUnknown, SamplesReleased
from storage.tables.findings import IdentificationRow
from storage.tables.measurements import RunRow


class NoModel(Conflict):
    """The identification cannot be restored as a model; the message states the reason."""


@dataclass(frozen=True)
class Identified:
    """A stored identification.

    machine: the document of its revision, under the conditions of its runs.
    point, covariance: (n,), (n, n) as in `Identification`.
    effects: effects of channels' errors on it; None by an older release.
    direction: sense of rotation of its runs, +1 from +x to +y.
    """

    id: int
    machine: Machine
    direction: int
    coordinates: tuple[str, ...]
    point: Floats
    covariance: Floats
    effects: ChannelEffects | None
    run_ids: tuple[int, ...]
    slow_roll: SlowRoll | None
    noise: Noise | None
    speed_minimum: float
    speed_maximum: float

    @cached_property
    def model(self) -> UpdatedModel:
        """Return the updated model in the sense of rotation of its runs."""
        return model_at(self.machine, self.coordinates, self.point, self.covariance).turning(self.direction)

    @property
    def with_errors(self) -> tuple[tuple[str, ...], Floats, Floats]:
        """Return names, values and covariance of the coordinates and of the channels' errors that they were found along."""
        return beside_its_errors(self.coordinates, self.point, self.covariance, self.effects, channels=self.machine.channels)

    def model_beside(self, causes: Iterable[tuple[str, str]]) -> UpdatedModel:
        """Return the model with errors of measuring chains free that causes stand for. causes: kind and element of each."""
        channels = self.machine.channels
        point, covariance = estimate_beside(self.point, self.covariance, self.effects, causes, channels=channels)
        return replace(self, point=point, covariance=covariance).model


@dataclass(frozen=True)
class UsedRun:
    """A run of an identification. machine: as fitted; measurement: input of the fit, (S, m).

    left_out: (S, m) phasors excluded for their quality. time: (S,) [ns].
    """

    id: int
    machine: Machine
    measurement: Measurement
    left_out: np.ndarray[tuple[int, ...], np.dtype[np.bool_]]
    time: np.ndarray[tuple[int], np.dtype[np.int64]]


def identified(session: Session, identification_id: int) -> Identified:
    """Read an identification. Raises IdentificationUnknown, NoModel."""
    row = identifications.get(session, identification_id)
    point = identifications.point(session, identification_id)
    if point is None:
        raise NoModel(
            f"identification {identification_id} is of an older release, which kept no model: identify its run again"
        )
    machine = under_conditions(machines.document(session, row.machine_id, row.revision), row.conditions or {})
    return Identified(
        id=row.id,
        machine=machine,
        direction=_direction(session, row, machine),
        coordinates=tuple(row.coordinates),
        point=point,
        covariance=identifications.covariance(row),
        effects=identifications.effects(session, identification_id),
        run_ids=tuple(row.run_ids),
        slow_roll=_vectors(session, row, machine),
        noise=_noise(row),
        speed_minimum=row.speed_minimum,
        speed_maximum=row.speed_maximum,
    )


def used_runs(session: Session, one: Identified, run_ids: Sequence[int]) -> list[UsedRun]:
    """Return those of some runs that still have samples, as the fit used them."""
    found = []
    for run_id in run_ids:
        try:
            held, flags = runs.samples(session, run_id), runs.flags(session, run_id)
        except (RunUnknown, SamplesReleased):
            continue
        if held is None or not len(held):
            continue
        machine, measurement = one.machine, held.measurement()
        if one.slow_roll is not None:
            machine, measurement = corrected(machine, measurement, one.slow_roll)
        left_out = ~measurement.usable if flags is None else (flags & np.uint16(EXCLUDING & 0xFFFF)) != 0
        found.append(UsedRun(run_id, machine, measurement, left_out, held.time))
    return found


def _direction(session: Session, row: IdentificationRow, machine: Machine) -> int:
    run = session.get(RunRow, row.run_ids[0]) if row.run_ids else None
    return machine.direction if run is None else run.direction


def _noise(row: IdentificationRow) -> Noise | None:
    if row.noise_relative is None:
        return None
    # Without validation: an estimated part may be zero.
    return Noise.model_construct(relative=row.noise_relative, floor=row.noise_floor or 0.0, estimated=False)


def _vectors(session: Session, row: IdentificationRow, machine: Machine) -> SlowRoll | None:
    if row.slow_roll_version is None:
        return None
    return slow_roll.vectors(slow_roll.get(session, row.machine_id, row.slow_roll_version), machine)
