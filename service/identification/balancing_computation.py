"""Computing steps of a field balancing in a worker process: runs and what is asked go there, fields of numbers come back."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.balancing.balancing_check import check_balancing
from estimator.balancing.field_balancing import (
    BalancingOptions,
    BalancingRun,
    FieldBalancing,
    balance_from_trials,
    mass_of_rotors,
)
from estimator.balancing.trial_runs import require_plausible_weight
from estimator.errors import Invalid
from estimator.machine.document import Machine
from estimator.updated_model.balancing import BalancingFailed, influence_coefficients
from service.balancing.rendering import check_fields, correction_fields
from service.identification.stored_model import Identified


class CorrectionImpossible(Invalid):
    """Raised when no correction within the limits is the best one."""


@dataclass(frozen=True)
class BalancingTask:
    """A correction to compute. model: an identification whose influence coefficients are compared; None for none."""

    machine: Machine
    initial: tuple[BalancingRun, ...]
    trials: tuple[BalancingRun, ...]
    options: BalancingOptions
    model: Identified | None


def compute_correction(task: BalancingTask) -> dict[str, Any]:
    """Return the fields of a correction. Raises TrialsUnusable, NoCommonSpeed, CorrectionImpossible."""
    return correction_fields(_balanced(task))


def compute_check(task: BalancingTask, run: BalancingRun) -> dict[str, Any]:
    """Return the fields of a check run after a correction. Raises what `compute_correction` raises."""
    found = _balanced(task)
    return check_fields(found, check_balancing(found, run))


def require_plausible_trial(machine: Machine, run: BalancingRun) -> None:
    """Raise TrialsUnusable for a weight in a wrong unit, before the next run is made."""
    mass, added = mass_of_rotors(machine), run.added
    for disc, one in zip(machine.discs, [] if added is None else np.abs(added).tolist(), strict=True):
        require_plausible_weight(one, name=run.name, plane=disc.id, mass=mass)


def _balanced(task: BalancingTask) -> FieldBalancing:
    one = task.model

    def influence(planes: tuple[str, ...], speed: Floats) -> Complexes:
        assert one is not None
        return influence_coefficients(one.model, planes=planes, speed=speed)

    try:
        return balance_from_trials(
            task.machine, task.initial, task.trials, options=task.options, model=None if one is None else influence
        )
    except BalancingFailed as error:
        raise CorrectionImpossible(str(error)) from error
