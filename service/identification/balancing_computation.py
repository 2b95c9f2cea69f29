"""Computing steps of a field balancing in a worker process: runs and what is asked go there, fields of numbers come back."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from estimator.balancing.balancing_check import check_balancing
from estimator.balancing.field_balancing import (
    BalancingOptions,
    BalancingRun,
    FieldBalancing,
    balance_from_trials,
)
from estimator.balancing.model_balancing import BalancingFailed
from estimator.balancing.model_influence import measured_model_influence
from estimator.balancing.plausible_weights import require_plausible_weights
from estimator.balancing.trial_runs import TrialsUnusable
from estimator.errors import Invalid
from estimator.machine.document import Machine
from estimator.phasors.measurement import Measurement
from service.balancing.rendering import check_fields, correction_fields
from service.identification.stored_model import Identified

CANCELLED = 1e-15
"""Unbalance that rounding leaves of weights which cancel each other [kg m]; the smallest that can be stated is 1e-12."""


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


def require_usable_trial(machine: Machine, run: BalancingRun, others: Sequence[BalancingRun]) -> None:
    """Raise TrialsUnusable, before the next run is made, for weights in a wrong unit or that cancel, and for a copied run."""
    if run.added is not None:
        require_plausible_weights(machine, run.added, name=run.name)
    if run.added is None or np.max(np.abs(run.added)) < CANCELLED:
        raise TrialsUnusable(
            f"{run.name}: its weights cancel each other, and a trial needs one that is felt: state all that was on"
        )
    for other in others:
        if _is_copy(run.measurement, other.measurement):
            raise TrialsUnusable(
                f"{other.name} and {run.name} hold the same vectors: one is a copy of the other, not a run with another trial "
                "weight"
            )


def _is_copy(one: Measurement, other: Measurement) -> bool:
    return np.array_equal(one.speed, other.speed) and np.array_equal(one.phasor, other.phasor, equal_nan=True)


def _balanced(task: BalancingTask) -> FieldBalancing:
    one = task.model
    model = None
    if one is not None:
        coordinates, point, _ = one.with_errors
        model = measured_model_influence(one.model, one.machine, coordinates, point)
    try:
        return balance_from_trials(task.machine, task.initial, task.trials, options=task.options, model=model)
    except BalancingFailed as error:
        raise CorrectionImpossible(str(error)) from error
