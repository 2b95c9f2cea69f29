"""Influence coefficients from trial runs, from a model, or from both, whichever predicts runs best that took no part.

A corrected model has A = g M + Δ at every measuring point: the model's coefficients M, one complex gain g for what the
measuring chain and the mounting change alike, and deviations Δ that are probably small beside M: ridge regression towards
the model (Hoerl and Kennard, Technometrics 12 (1970) 55, doi:10.1080/00401706.1970.10488634) with a prior of a known
spread. Runs with the same trial weights are left out together and predicted from the others (Stone, J. R. Stat. Soc. B 36
(1974) 111, doi:10.1111/j.2517-6161.1974.tb00994.x).
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.balancing.measured_influence import MeasuredInfluence, estimate_scatter, expected_variance, measure_influence
from estimator.balancing.trial_runs import TrialRuns, TrialsUnusable

InfluenceMethod = Literal["influence coefficients", "model", "scaled model", "corrected model"]
METHODS: tuple[InfluenceMethod, ...] = ("influence coefficients", "model", "scaled model", "corrected model")
USUAL_DEVIATION = 0.2
"""Prior spread of a coefficient about the scaled model's, as a part of it [-]."""
CLEARLY_BETTER = 0.98
"""Error of a model's predictions over that of the trials alone [-] below which the model is used."""
UNKNOWN_NOISE = 0.1
"""Error of a vector where nothing is known of it, as a part of what the trial weights change [-]."""


@dataclass(frozen=True)
class HeldOutError:
    """Error of a method where it predicts runs that took no part.

    Attributes:
        method: The method.
        error: Rms error of the predicted vectors over the rms of what the trial weights changed [-]; None where no run can be
            left out.
    """

    method: InfluenceMethod
    error: float | None


@dataclass(frozen=True)
class ChosenInfluence:
    """Influence coefficients with the method that they come from.

    Attributes:
        method: The method.
        influence: The coefficients.
        compared: All methods that were compared, the best one first.
        words: Sentence that says which method was taken and why.
    """

    method: InfluenceMethod
    influence: MeasuredInfluence
    compared: tuple[HeldOutError, ...]
    words: str


def choose_influence(
    runs: TrialRuns, *, model: Complexes | None = None, method: InfluenceMethod | None = None
) -> ChosenInfluence:
    """Compute influence coefficients by the method that predicts held-out runs best (Stone 1974).

    Args:
        runs: The initial run and trial runs, that show every point.
        model: The model's influence coefficients (K, Q) [m/(kg m)]; None without a model.
        method: A method to take whatever the comparison says; None to choose.

    Returns:
        The coefficients, and how the methods compare.

    Raises:
        TrialsUnusable: The runs cannot determine what the method needs.
    """
    names = METHODS if model is not None else METHODS[:1]
    if method is not None and method not in names:
        raise TrialsUnusable(f"the method '{method}' needs a model")
    errors = {name: _held_out(runs, model, name) for name in names}
    known = sorted((name for name in names if errors[name] is not None), key=lambda name: errors[name] or 0.0)
    # Trials that cannot be left out cannot be compared: they are the usual practice, and need no model; nor does a tie.
    own = errors["influence coefficients"]
    best = known[0] if own is not None and (errors[known[0]] or 0.0) < CLEARLY_BETTER * own else "influence coefficients"
    chosen = method or best
    unknown = [name for name in names if errors[name] is None]
    return ChosenInfluence(
        method=chosen,
        influence=fit_influence(runs, model, chosen),
        compared=tuple(HeldOutError(name, errors[name]) for name in [*known, *unknown]),
        words=_words(chosen, method, errors),
    )


def fit_influence(runs: TrialRuns, model: Complexes | None, method: InfluenceMethod) -> MeasuredInfluence:
    """Compute influence coefficients by one method (Hoerl and Kennard 1970 for the corrected model).

    Source: Goodman, J. Eng. Ind. 86 (1964) 273, doi:10.1115/1.3670532, and Hoerl and Kennard, Technometrics 12 (1970) 55,
    doi:10.1080/00401706.1970.10488634.

    Args:
        runs: Runs that show every point.
        model: The model's influence coefficients (K, Q) [m/(kg m)]; None where the method needs none.
        method: The method.

    Returns:
        The coefficients.

    Raises:
        TrialsUnusable: The runs cannot determine what the method needs.
    """
    if method == "influence coefficients" or model is None:
        return measure_influence(runs)
    noise = _noise(runs, model)
    fits = [_fit_point(runs, model[point], noise[point], point, method) for point in range(len(runs.points))]
    left = np.stack([one.left for one in fits], axis=1)
    scatter, freedom, shares = estimate_scatter(runs, left, spent=float(np.mean([one.spent for one in fits])))
    if not np.isfinite(freedom):
        scatter = np.diag(noise).astype(complex)
    own = np.real(np.diag(scatter))
    spread = np.stack([one.spread for one in fits])
    # Spreads were computed with the expected noise; where the scatter is larger, they grow with it.
    grown = np.maximum(1.0, np.divide(own, noise, out=np.ones_like(own), where=noise > 0.0))
    solution = np.stack([one.solution for one in fits])
    return MeasuredInfluence(
        planes=runs.planes,
        points=runs.points,
        influence=solution[:, 1:],
        offset=solution[:, 0],
        spread=spread * grown[:, None, None],
        scatter=scatter,
        freedom=freedom,
        shares=shares,
    )


@dataclass(frozen=True)
class _PointFit:
    """Fit of one measuring point: offset and coefficients (Q + 1,), their covariance, residuals (R,) and unknowns spent."""

    solution: Complexes
    spread: Complexes
    left: Complexes
    spent: float


def _fit_point(runs: TrialRuns, model: Complexes, noise: float, point: int, method: InfluenceMethod) -> _PointFit:
    """Fit offset, gain and deviations of one point, those that a method leaves free, in units of the model."""
    planes, shown = len(runs.planes), np.isfinite(runs.vector[:, point])
    response = runs.added[shown] * model
    mapped = np.zeros((planes + 1, planes + 2), dtype=complex)
    mapped[0, 0] = 1.0
    mapped[1:, 1] = model
    mapped[1:, 2:] = np.diag(model)
    free = {"model": [0], "scaled model": [0, 1]}.get(method, list(range(planes + 2)))
    design = np.concatenate([np.ones((len(response), 1)), response.sum(axis=1, keepdims=True), response], axis=1)
    target = runs.vector[shown, point] - (0.0 if 1 in free else design[:, 1])
    prior = np.concatenate([[0.0, 0.0], np.full(planes, noise / USUAL_DEVIATION**2)])[free]
    # Deviations are parts of the model's coefficients: noise is in the vibration that a typical weight makes.
    normal = np.conj(design[:, free]).T @ design[:, free] + np.diag(prior)
    inverse = np.linalg.pinv(normal, hermitian=True)
    unknown = np.zeros(planes + 2, dtype=complex)
    unknown[1] = 1.0
    unknown[free] = inverse @ (np.conj(design[:, free]).T @ target)
    spent = float(np.real(np.trace(inverse @ (normal - np.diag(prior)))))
    spread = mapped[:, free] @ (noise * inverse) @ np.conj(mapped[:, free]).T
    left = np.full(len(runs.names), complex(np.nan, np.nan))
    left[shown] = runs.vector[shown, point] - design @ unknown
    return _PointFit(mapped @ unknown, spread.astype(complex), left, spent)


def _noise(runs: TrialRuns, model: Complexes) -> Floats:
    """Return the variance (K,) of a vector: as the trials' regression leaves it, the expected one, or part of the changes."""
    try:
        found = np.real(np.diag(measure_influence(runs).scatter))
    except TrialsUnusable:
        found = expected_variance(runs)
    size = np.nanmean(np.abs(runs.vector) ** 2, axis=0)
    changed = np.mean(np.abs(runs.added @ model.T) ** 2, axis=0)
    stand_in = UNKNOWN_NOISE**2 * np.minimum(size, changed) + 1e-12 * size
    return np.asarray(np.where(found > 0.0, found, stand_in))


def _held_out(runs: TrialRuns, model: Complexes | None, method: InfluenceMethod) -> float | None:
    """Return the relative error of predictions of runs whose trial weights took no part; None where none can be left out."""
    keys = [tuple(np.round(row / max(1e-300, np.abs(runs.added).max()), 9)) for row in runs.added]
    middle = np.nanmean(runs.vector, axis=0)
    size = np.sqrt(np.nanmean(np.abs(runs.vector - middle) ** 2, axis=0))
    size = np.where(size > 0.0, size, 1.0)
    missed: list[Complexes] = []
    for key in dict.fromkeys(keys):
        out = [number for number, one in enumerate(keys) if one == key]
        try:
            found = fit_influence(runs.pick([number for number, one in enumerate(keys) if one != key]), model, method)
        except TrialsUnusable:
            if method == "influence coefficients":
                return None
            continue
        predicted = found.offset + runs.added[out] @ found.influence.T
        missed.append((runs.vector[out] - predicted) / size)
    return float(np.sqrt(np.nanmean(np.abs(np.concatenate(missed)) ** 2))) if missed else None


def _words(chosen: InfluenceMethod, given: InfluenceMethod | None, errors: dict[InfluenceMethod, float | None]) -> str:
    told = {name: f"{100 * error:.3g} %" for name, error in errors.items() if error is not None}
    listed = ", ".join(f"{name} {error}" for name, error in sorted(told.items(), key=lambda one: errors[one[0]] or 0.0))
    measure = "errors of predicted vectors over what the trial weights changed, runs left out in turn"
    if errors["influence coefficients"] is None:
        reason = (
            "with these trials no run can be left out to compare them with the model"
            if len(errors) > 1
            else ("with these trials no run can be left out to test them")
        )
        return f"{chosen} taken{' as asked' if given else ''}; {reason}"
    if len(errors) == 1:
        return f"influence coefficients, {told['influence coefficients']} ({measure})"
    reason = ", no model predicts clearly better" if chosen == "influence coefficients" else ", which predicts best"
    return f"{chosen} taken{' as asked' if given else reason}: {listed} ({measure})"
