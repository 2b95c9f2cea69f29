"""Regressions of the thesis from equations of motion at measured phasors, for constant and speed-dependent coefficients."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.rotor.parameters import Unknowns
from estimator.thesis.flexible_train import parts
from estimator.thesis.reduced_model import ResponseEquations
from estimator.thesis.regression import Regression, real_rows


def real_names(unknowns: Unknowns) -> tuple[str, ...]:
    """List the names of the K + 2P real unknowns.

    Args:
        unknowns: The unknowns.

    Returns:
        Names, coefficients first.
    """
    planes = [f"{plane.name}.{part}" for plane in unknowns.unbalances for part in ("real", "imaginary")]
    return tuple([one.name for one in unknowns.coefficients] + planes)


def with_trial_unbalances(equations: ResponseEquations, trial: Complexes) -> ResponseEquations:
    """Return the equations for known trial unbalances on the discs beside the unknown ones (thesis §4.5).

    Args:
        equations: The equations.
        trial: Trial unbalances (S, P) [kg m].

    Returns:
        The equations with the trial unbalances on the right-hand side.
    """
    moved = (equations.unbalance @ parts(trial)[..., None])[..., 0]
    return ResponseEquations(equations.coefficient, equations.unbalance, equations.target - moved)


def speed_independent_regression(
    equations: ResponseEquations, unknowns: Unknowns, *, mean_speed: float, damping_scaled: bool
) -> Regression:
    """Build the regression with one value of each unknown for all speeds (thesis Eq. 3.41, 4.71).

    Args:
        equations: The equations.
        unknowns: The unknowns.
        mean_speed: ω_a of the thesis's column scaling 1/ω_a, which acts on the unbalances (§2.3.2) [rad/s].
        damping_scaled: Whether it acts on the damping coefficients too (§4.5).

    Returns:
        The regression.
    """
    columns = np.concatenate([equations.coefficient, equations.unbalance], axis=2)
    return Regression(
        matrix=real_rows(columns.reshape(-1, columns.shape[2])),
        target=real_rows(equations.target.reshape(-1)),
        names=real_names(unknowns),
        thesis_scale=_thesis_scale(unknowns, mean_speed, damping_scaled),
    )


def speed_dependent_regression(
    equations: ResponseEquations, unknowns: Unknowns, *, group: NDArray[np.intp], mean_speed: float
) -> Regression:
    """Build the regression with coefficients of their own for each group of samples, one set of unbalances for all.

    Source: thesis Eq. 4.66-4.70. The names of a group's coefficients end in "@" and its number; the unbalances come last.

    Args:
        equations: The equations.
        unknowns: The unknowns.
        group: Number of each sample's group (S,), from 0; a group is one speed with all its runs.
        mean_speed: ω_a of the thesis's column scaling 1/ω_a [rad/s].

    Returns:
        The regression.

    Raises:
        ValueError: The groups are not numbered without gaps.
    """
    count = int(group.max()) + 1
    if not np.array_equal(np.unique(group), np.arange(count)):
        raise ValueError("the groups must be numbered 0, 1, 2, ... without gaps")
    samples, rows, width = equations.coefficient.shape
    planes = equations.unbalance.shape[2]
    columns = np.zeros((samples, rows, count * width + planes), dtype=complex)
    for number in range(count):
        members = group == number
        columns[members, :, number * width : (number + 1) * width] = equations.coefficient[members]
    columns[:, :, count * width :] = equations.unbalance
    names = real_names(unknowns)
    scale = _thesis_scale(unknowns, mean_speed, damping_scaled=True)
    return Regression(
        matrix=real_rows(columns.reshape(samples * rows, -1)),
        target=real_rows(equations.target.reshape(-1)),
        names=(*_numbered(names[:width], count), *names[width:]),
        thesis_scale=np.concatenate([np.tile(scale[:width], count), scale[width:]]),
    )


def _numbered(names: Sequence[str], count: int) -> tuple[str, ...]:
    return tuple(f"{name}@{number}" for number in range(count) for name in names)


def _thesis_scale(unknowns: Unknowns, mean_speed: float, damping_scaled: bool) -> Floats:
    damping = np.array([damping_scaled and one.quantity == "damping" for one in unknowns.coefficients])
    scaled = np.concatenate([damping, np.ones(2 * len(unknowns.unbalances), dtype=bool)])
    return np.where(scaled, 1.0 / mean_speed, 1.0)
