"""Runs of the store as the runs of a balancing: without the slow roll in force, with the weights that were on."""

import cmath
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from msgspec.structs import replace
from sqlalchemy.orm import Session

from estimator.arrays import Complexes
from estimator.balancing.balance_quality import GRAM_MILLIMETRE
from estimator.balancing.field_balancing import BalancingRun
from estimator.calibration.calibrated_document import is_the_same_but_for_calibrations
from estimator.errors import Invalid
from estimator.machine.document import Machine
from estimator.phasors.slow_roll import corrected
from storage.machines import machines, slow_roll
from storage.measurements import runs


class RunUnsuitable(Invalid):
    """Raised for a run that cannot be part of a balancing: open, of another machine or of another train."""


@dataclass(frozen=True)
class StoredWeight:
    """An unbalance on a disc [g mm, °], from the keyphasor mark on, +x to +y."""

    disc: str
    g_mm: float
    angle_deg: float


def balancing_run(
    session: Session, machine_id: str, revision: int, run_id: int, weights: Sequence[StoredWeight] | None
) -> BalancingRun:
    """Return a stored run with its weights; None for weights that nobody stated.

    Raises RunUnknown, RunUnsuitable, SamplesReleased.
    """
    row = runs.get(session, run_id)
    if row.machine_id != machine_id:
        raise RunUnsuitable(f"run {run_id} is one of machine '{row.machine_id}', not of '{machine_id}'")
    machine = machines.document(session, machine_id, revision)
    measured_under = machine if row.revision == revision else machines.document(session, machine_id, row.revision)
    if not is_the_same_but_for_calibrations(machine, measured_under):
        raise RunUnsuitable(
            f"run {run_id} was measured under revision {row.revision} of the document, which describes another train than "
            f"revision {revision}, under which this balancing began"
        )
    held = runs.samples(session, run_id)
    if held is None or len(held) == 0:
        raise RunUnsuitable(f"run {run_id} is still open, or has no samples: wait until it is closed")
    measurement = held.measurement()
    version = machines.get(session, machine_id).slow_roll_version
    if version is not None:
        vectors = slow_roll.vectors(slow_roll.get(session, machine_id, version), machine)
        measurement = corrected(machine, measurement, vectors)[1]
    if weights is None:
        return BalancingRun(f"run {run_id}", measurement)
    return BalancingRun(f"run {run_id}", replace(measurement, added=None).with_trial_weight(added_unbalance(machine, weights)))


def read_weights(weights: Sequence[Mapping[str, float | str]]) -> list[StoredWeight]:
    """Return weights as a balancing's steps hold them."""
    return [StoredWeight(str(one["disc"]), float(one["g_mm"]), float(one["angle_deg"])) for one in weights]


def added_unbalance(machine: Machine, weights: Sequence[StoredWeight]) -> Complexes:
    """Return the unbalance that weights add to each disc (P,) [kg m]. Raises RunUnsuitable for an unknown disc."""
    discs = [disc.id for disc in machine.discs]
    added = np.zeros(len(discs), dtype=complex)
    for one in weights:
        if one.disc not in discs:
            raise RunUnsuitable(f"there is no disc {one.disc}; the discs are {', '.join(discs)}")
        # Several weights on one disc act as their sum.
        added[discs.index(one.disc)] += cmath.rect(one.g_mm * GRAM_MILLIMETRE, math.radians(one.angle_deg))
    return added
