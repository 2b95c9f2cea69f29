"""Propagation of errors by central differences, which judges the exact derivatives of the packages."""

from collections.abc import Callable

import numpy as np
from msgspec.structs import replace

from estimator.arrays import Floats
from estimator.updated_model.model import UpdatedModel

STEP = 1e-2
"""Step of the central differences, in standard deviations [-]."""


def propagated(function: Callable[[UpdatedModel], Floats], model: UpdatedModel) -> Floats:
    """Compute the covariance of any function's real values by central differences.

    Differences run along the principal axes of the covariance, a hundredth of a standard deviation to either side, so that no
    step size has to be chosen for parameters of different units.

    Args:
        function: Function of a model that returns q values (q,) [any unit].
        model: Model at whose values, and with whose covariance, errors are propagated.

    Returns:
        Covariance (q, q) [unit²].
    """
    columns = []
    for axis in principal_axes(model.covariance).T:
        ahead, behind = (function(replace(model, values=model.values + sign * STEP * axis)) for sign in (1.0, -1.0))
        columns.append((ahead - behind) / (2 * STEP))
    slope = np.array(columns).T
    return np.asarray(slope @ slope.T)


def principal_axes(covariance: Floats) -> Floats:
    """Separate a covariance into independent errors of one standard deviation each.

    Args:
        covariance: Covariance (n, n) [unit²].

    Returns:
        Columns A (n, n) with A Aᵀ = covariance [unit].
    """
    size = np.sqrt(np.diag(covariance))
    unit = np.where(size > 0.0, size, 1.0)
    values, vectors = np.linalg.eigh(covariance / np.outer(unit, unit))
    return np.asarray(unit[:, None] * vectors * np.sqrt(np.maximum(values, 0.0)))
