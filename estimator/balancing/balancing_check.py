"""The check run after a correction: against the prediction, against ISO 21940-11 and vibration limits, and what to trim.

The check run is one more run with a known weight: it renews the influence coefficients, from which the further correction
comes (Goodman, J. Eng. Ind. 86 (1964) 273, doi:10.1115/1.3670532).
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from estimator.arrays import Complexes
from estimator.balancing.equivalent_unbalance import equivalent_unbalance
from estimator.balancing.field_balancing import (
    ROUNDING,
    BalancingRun,
    FieldBalancing,
    residual_balance,
    vectors_of,
)
from estimator.balancing.influence_correction import correct
from estimator.balancing.plausible_weights import require_plausible_weights
from estimator.balancing.trial_runs import TrialsUnusable, are_copies, in_sense_of_rotation
from estimator.updated_model.balance_quality import RotorBalance
from estimator.updated_model.uncertainty import PhasorBand

LimitVerdict = Literal["met", "not met", "open"]
"""Verdict on a vibration limit; 'open' where the prediction is not sure enough to tell."""


@dataclass(frozen=True)
class BalancingCheck:
    """A check run beside what was promised.

    Attributes:
        name: Name of the run.
        installed: Unbalances (Q,) that were on, in the planes of the correction [kg m].
        vector: Vectors (K,) of the run [m], NaN where it shows none.
        predicted: Prediction (K,) for the weights that were on [m].
        held: True for the points (K,) whose amplitude lies within the prediction.
        residual: Residual unbalance by rotor, as the run shows it.
        trim: Unbalances (Q,) to add to those that are on [kg m].
        after_trim: Vibration predicted with them at the points that the run shows (K,) [m].
    """

    name: str
    installed: Complexes
    vector: Complexes
    predicted: PhasorBand
    held: NDArray[np.bool_]
    residual: tuple[RotorBalance, ...]
    trim: Complexes
    after_trim: PhasorBand


def check_balancing(found: FieldBalancing, run: BalancingRun) -> BalancingCheck:
    """Compare a check run with the prediction of a correction (Goodman 1964, doi:10.1115/1.3670532).

    Args:
        found: The correction.
        run: The run. Without stated weights, the proposed ones are taken to be on.

    Returns:
        What the run shows.

    Raises:
        TrialsUnusable: The run has none of the correction's speeds, weights in planes that had no trial or in another unit, or
            is a copy of one that the correction came from.
    """
    machine, planes = found.machine, found.separation.planes
    vector = _vectors(found, run)
    installed = _installed(found, run)
    weight = in_sense_of_rotation(installed, machine.direction)
    predicted = found.correction.installed(weight).after
    amplitude = np.abs(vector)
    shown = np.isfinite(vector)
    held = shown & (amplitude >= predicted.lower) & (amplitude <= predicted.upper)
    residual, covariance = equivalent_unbalance(found.known, vector)
    widened = found.known.widening**2 * covariance
    limit = np.array([found.options.limit.get(plane, np.inf) for plane in planes])
    further = correct(found.correction.influence.from_state(vector, weight), criterion=found.options.criterion, limit=limit)
    return BalancingCheck(
        name=run.name,
        installed=installed,
        vector=vector,
        predicted=predicted,
        held=held,
        residual=residual_balance(found, residual, widened),
        trim=in_sense_of_rotation(_change(weight, further.weight), machine.direction),
        after_trim=further.after,
    )


def _change(before: Complexes, after: Complexes) -> Complexes:
    """Return what weights (Q,) change by, zero where that is a rounding error."""
    change = after - before
    return np.where(np.abs(change) > ROUNDING * np.maximum(np.abs(before), np.abs(after)), change, 0.0)


def limit_verdict(band: PhasorBand, limit: float) -> LimitVerdict:
    """Judge predicted vibration by a limit.

    Args:
        band: Vibration at some points [m].
        limit: Largest amplitude allowed, 0-to-peak [m].

    Returns:
        Whether all points keep it; open where that is not sure.
    """
    if np.all(band.upper <= limit):
        return "met"
    return "not met" if np.any(band.lower > limit) else "open"


def _vectors(found: FieldBalancing, run: BalancingRun) -> Complexes:
    """Return the run's vectors at the points of the correction."""
    seen = vectors_of(found.machine, [run], found.speed)
    vector = seen.vector[0][[seen.points.index(point) for point in found.runs.points]]
    if not np.any(np.isfinite(vector)):
        raise TrialsUnusable(f"{run.name} shows none of the speeds at which the machine was balanced")
    for name, before in zip(found.runs.names, found.runs.vector, strict=True):
        if are_copies(vector, before):
            raise TrialsUnusable(
                f"{run.name} holds the same vectors as {name}: a check run is a run of its own, after the correction"
            )
    return np.asarray(vector)


def _installed(found: FieldBalancing, run: BalancingRun) -> Complexes:
    if run.added is None:
        return found.unbalance
    discs = [disc.id for disc in found.machine.discs]
    planes = found.separation.planes
    other = [disc for disc, one in zip(discs, run.added, strict=True) if one != 0.0 and disc not in planes]
    if other:
        raise TrialsUnusable(f"{run.name}: weights on {', '.join(other)}, where nothing was to be corrected")
    require_plausible_weights(found.machine, run.added, name=run.name)
    return np.array([run.added[discs.index(plane)] for plane in planes])
