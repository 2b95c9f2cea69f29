"""The check run after a correction: against the prediction, against ISO 21940-11 and vibration limits, and what to trim.

The check run is one more run with a known weight: it renews the influence coefficients, from which the further correction
comes (Goodman, J. Eng. Ind. 86 (1964) 273, doi:10.1115/1.3670532).
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
import scipy.special
from numpy.typing import NDArray

from estimator.arrays import Complexes
from estimator.balancing.balance_quality import RotorBalance
from estimator.balancing.equivalent_unbalance import equivalent_unbalance
from estimator.balancing.field_balancing import (
    ROUNDING,
    BalancingRun,
    FieldBalancing,
    residual_balance,
    vectors_of,
)
from estimator.balancing.influence_correction import InfluenceCorrection, correct
from estimator.balancing.measured_influence import circular_band
from estimator.balancing.plausible_weights import require_plausible_weights
from estimator.balancing.trial_runs import TrialsUnusable, are_copies, in_sense_of_rotation
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
        beside: Unbalances by disc that were on elsewhere [kg m].
        unpredicted: Those of these discs that had no trial run, so that nothing is predicted for what was on.
        predicted: Prediction (K,) for the weights that were on [m]; None where there is none.
        held: True for the points (K,) whose amplitude lies within the prediction.
        residual: Residual unbalance by rotor, as the run shows it.
        trim: Unbalances (Q,) to add to those that are on [kg m].
        trim_band: Their 95 % bands [kg m].
        is_trim_noise: Whether the trim, in all planes together, cannot be told from noise.
        after_trim: Vibration predicted with them at the points that the run shows (K,) [m].
    """

    name: str
    installed: Complexes
    beside: Mapping[str, complex]
    unpredicted: tuple[str, ...]
    vector: Complexes
    predicted: PhasorBand | None
    held: NDArray[np.bool_]
    residual: tuple[RotorBalance, ...]
    trim: Complexes
    trim_band: PhasorBand
    is_trim_noise: bool
    after_trim: PhasorBand


def check_balancing(found: FieldBalancing, run: BalancingRun) -> BalancingCheck:
    """Compare a check run with the prediction of a correction (Goodman 1964, doi:10.1115/1.3670532).

    Args:
        found: The correction.
        run: The run. Without stated weights, the proposed ones are taken to be on.

    Returns:
        What the run shows.

    Raises:
        TrialsUnusable: The run has none of the correction's speeds, weights in another unit, or is a copy of one that the
            correction came from.
    """
    machine, planes = found.machine, found.separation.planes
    vector = _vectors(found, run)
    installed, beside = _installed(found, run)
    weight = in_sense_of_rotation(installed, machine.direction)
    predicted = _predicted(found, installed, beside)
    amplitude = np.abs(vector)
    shown = np.isfinite(vector)
    if predicted is None:
        held = np.zeros_like(shown)
    else:
        held = shown & (amplitude >= predicted.lower) & (amplitude <= predicted.upper)
    residual, covariance = equivalent_unbalance(found.known, vector)
    widened = found.known.widening**2 * covariance
    limit = np.array([found.options.limit.get(plane, np.inf) for plane in planes])
    # What is on in other planes stays there: it is part of the vibration from which the planes are corrected further.
    further = correct(found.correction.influence.from_state(vector, weight), criterion=found.options.criterion, limit=limit)
    trim = in_sense_of_rotation(_change(weight, further.weight), machine.direction)
    return BalancingCheck(
        name=run.name,
        installed=installed,
        beside=beside,
        unpredicted=tuple(disc for disc in beside if disc not in found.choice.influence.planes),
        vector=vector,
        predicted=predicted,
        held=held,
        residual=residual_balance(found, residual, widened),
        trim=trim,
        trim_band=circular_band(trim, np.real(np.diag(further.covariance)), widening=further.influence.widening),
        is_trim_noise=_is_noise(in_sense_of_rotation(trim, machine.direction), further),
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


def _predicted(found: FieldBalancing, installed: Complexes, beside: Mapping[str, complex]) -> PhasorBand | None:
    """Predict the vibration for weights in the correction's planes (Q,) and beside; None where a disc had no trial run."""
    known, direction = found.choice.influence, found.machine.direction
    if not beside:
        return found.correction.influence.predicted(in_sense_of_rotation(installed, direction))
    if any(disc not in known.planes for disc in beside):
        return None
    whole = dict(zip(found.separation.planes, installed.tolist(), strict=True)) | dict(beside)
    weight = np.array([whole.get(plane, 0.0) for plane in known.planes], dtype=complex)
    return known.predicted(in_sense_of_rotation(weight, direction))


def _is_noise(change: Complexes, further: InfluenceCorrection) -> bool:
    """Return whether a change of weights (Q,), in all planes together, is within its 95 % region (Hotelling's T²).

    Planes that do nearly the same may each be within their own interval, and their sum is not.
    """
    size = np.sqrt(np.real(np.diag(further.covariance)))
    if not np.all(size > 0.0):
        return not np.any(change)
    correlation = further.covariance / np.outer(size, size)
    scaled = change / size
    # Complex errors: 2 |x|² over the variance has two degrees of freedom a plane.
    distance = 2.0 * float(np.real(np.conj(scaled) @ np.linalg.pinv(correlation, hermitian=True) @ scaled))
    count, freedom = 2 * change.size, further.influence.freedom
    if not np.isfinite(freedom):
        return distance <= float(scipy.special.chdtri(count, 0.05))
    return distance <= count * float(scipy.special.fdtri(count, freedom, 0.95))


def _installed(found: FieldBalancing, run: BalancingRun) -> tuple[Complexes, dict[str, complex]]:
    """Return the weights that were on in the correction's planes (Q,), and those by disc that were elsewhere."""
    if run.added is None:
        return found.unbalance, {}
    discs = [disc.id for disc in found.machine.discs]
    planes = found.separation.planes
    beside = {disc: complex(one) for disc, one in zip(discs, run.added, strict=True) if one != 0.0 and disc not in planes}
    require_plausible_weights(found.machine, run.added, name=run.name)
    return np.array([run.added[discs.index(plane)] for plane in planes]), beside
