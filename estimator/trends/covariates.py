"""Operating conditions as covariates: parameters as they would have been under the baseline's mean conditions.

Over the baseline's runs ln p = mean + B (c - c̄) + error. The covariance V of the error is that of the fits and of the
run-to-run scatter. B has a normal prior: a usual change of a condition is expected to move ln p by PRIOR_EFFECT rms. In the
principal axes of V the errors are independent and the prior is the same, so that each axis has the ridge regression
(CᵀC/λ + D⁻¹)⁻¹ Cᵀy/λ with its own covariance (Hoerl & Kennard, Technometrics 12 (1970) 55, doi:10.1080/00401706.1970.10488634;
as a posterior mean: Lindley & Smith, J. R. Stat. Soc. B 34 (1972) 1).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats
from estimator.machine.parameter_description import is_direct
from estimator.machine.rules import Condition
from estimator.symmetric_eigen import symmetric_eigen
from estimator.trends.parameter_vector import Point

PRIOR_SCATTER = 0.02
"""Run-to-run standard deviation of a logarithm beside the fits' errors [-]."""
PRIOR_EFFECT = 0.01
"""Prior standard deviation [-] of the change of a parameter's logarithm by a usual change of one condition."""
USUAL_CHANGE = {"degC": 10.0, "K": 10.0, "%": 20.0}
"""Usual change of a condition by its unit, where the document gives none."""
FEWEST_RUNS = 4
"""Least number of baseline runs for an adjustment."""

Measured = Mapping[str, float | None]
"""Mean of each condition over a run by name; None, or no entry, where it was not measured."""


@dataclass(frozen=True)
class Adjustment:
    """Dependence of p parameters of a machine on k conditions.

    Attributes:
        parameters: Names (p,) of direct terms, taken as logarithms.
        conditions: Names (k,) of the conditions; none where nothing can be said.
        mean: Mean (k,) of each condition over the baseline [unit of the condition].
        slope: Slopes B (p, k) of the logarithms [1/unit of the condition].
        axes: Principal axes (p, p) of the errors, in columns [-].
        uncertainty: Covariance (p, k, k) of B along each axis [1/unit²].
    """

    parameters: tuple[str, ...]
    conditions: tuple[str, ...]
    mean: Floats
    slope: Floats
    axes: Floats
    uncertainty: Floats

    def adjusted(self, point: Point, measured: Measured) -> Point:
        """Move a point to the baseline's mean conditions and enlarge its covariance by the uncertainty of the move.

        A condition that was not measured with it is taken to have been at its mean. Parameters that were not regressed stay.

        Args:
            point: The point.
            measured: Conditions that were measured with it.

        Returns:
            The adjusted point.
        """
        common = [name for name in point.names if name in self.parameters]
        values = [measured.get(name) for name in self.conditions]
        change = np.array([0.0 if value is None else value for value in values]) - self.mean
        change[[value is None for value in values]] = 0.0
        if not common or not np.any(change):
            return point
        places = [point.names.index(name) for name in common]
        rows = [self.parameters.index(name) for name in common]
        value, covariance = point.value.copy(), point.covariance.copy()
        value[places] -= self.slope[rows] @ change
        spread = np.einsum("akl,k,l->a", self.uncertainty, change, change)
        covariance[np.ix_(places, places)] += (self.axes[rows] * spread) @ self.axes[rows].T
        return Point(point.names, value, covariance)


def adjustment(
    baseline: Sequence[Point],
    measured: Sequence[Measured],
    conditions: Sequence[Condition],
    *,
    effect: float = PRIOR_EFFECT,
    scatter: float = PRIOR_SCATTER,
) -> Adjustment:
    """Regress a baseline's direct terms on the conditions that were measured with its runs.

    Ridge regression (Hoerl & Kennard 1970, doi:10.1080/00401706.1970.10488634). Conditions measured in fewer than FEWEST_RUNS
    runs are left out, and runs in which one of the others is missing; with fewer than FEWEST_RUNS left nothing is adjusted.

    Args:
        baseline: Points of the baseline's runs.
        measured: Conditions measured with each run.
        conditions: The machine's conditions.
        effect: Prior standard deviation of the effect of a usual change on ln p [-].
        scatter: Run-to-run standard deviation of ln p beside the fits' errors [-].

    Returns:
        The adjustment.

    Raises:
        ValueError: Runs and sets of measured conditions are not equally many.
    """
    if len(baseline) != len(measured):
        raise ValueError(f"{len(measured)} sets of conditions for {len(baseline)} runs")
    table = np.array([[_number(one.get(condition.name)) for condition in conditions] for one in measured])
    table = table.reshape(len(baseline), len(conditions))
    usable = np.count_nonzero(np.isfinite(table), axis=0) >= FEWEST_RUNS
    runs = np.flatnonzero(np.all(np.isfinite(table[:, usable]), axis=1))
    if runs.size < FEWEST_RUNS:
        return _no_adjustment()
    table = table[runs]
    width = np.array([_width(condition, table[:, i]) for i, condition in enumerate(conditions)])
    used = np.flatnonzero(usable & (width > 0.0))
    points = [baseline[run] for run in runs.tolist()]
    names = tuple(name for name in points[0].names if is_direct(name) and all(name in point.names for point in points))
    if used.size == 0 or not names:
        return _no_adjustment()
    mean = table[:, used].mean(axis=0)
    slope, axes, uncertainty = _ridge(
        table[:, used] - mean, [point.of(names) for point in points], prior=effect / width[used], scatter=scatter
    )
    return Adjustment(names, tuple(conditions[i].name for i in used.tolist()), mean, slope, axes, uncertainty)


def _ridge(change: Floats, points: Sequence[Point], *, prior: Floats, scatter: float) -> tuple[Floats, Floats, Floats]:
    """Regress on changes (n, k): slopes (p, k), axes (p, p), covariances (p, k, k); prior: standard deviations (k,)."""
    values = np.array([point.value for point in points])
    own = np.mean([point.covariance for point in points], axis=0)
    variance, axes = symmetric_eigen(own + scatter**2 * np.eye(own.shape[0]))
    along = (values - values.mean(axis=0)) @ axes
    precision = (change.T @ change)[None] / variance[:, None, None] + np.diag(prior**-2.0)[None]
    uncertainty = np.linalg.inv(precision)
    slope = np.einsum("akl,la->ak", uncertainty, change.T @ along / variance)
    return np.asarray(axes @ slope), axes, np.asarray(uncertainty)


def _number(value: float | None) -> float:
    return np.nan if value is None else float(value)


def usual_change(condition: Condition) -> float | None:
    """Return the usual change of a condition.

    Args:
        condition: The condition.

    Returns:
        Change [unit of the condition]; None where neither document nor unit gives it.
    """
    return condition.usual_change or USUAL_CHANGE.get(condition.unit)


def _width(condition: Condition, values: Floats) -> float:
    """Return the usual change of a condition, else its scatter in the baseline where neither document nor unit gives it."""
    given = usual_change(condition)
    return given if given is not None else float(np.std(values, ddof=1))


def _no_adjustment() -> Adjustment:
    none = np.empty(0)
    return Adjustment((), (), none, np.empty((0, 0)), np.empty((0, 0)), np.empty((0, 0, 0)))
