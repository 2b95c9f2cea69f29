"""Corrections from measured influence coefficients, and what they leave, with the calibration's uncertainty.

Least squares with weights (Goodman, J. Eng. Ind. 86 (1964) 273, doi:10.1115/1.3670532) or the least largest vibration,
each within limits of the planes. The prediction of what is left is that of a further run: errors of the coefficients, of
the initial vibration and of the run itself are in it (first order, JCGM 100:2008, 5.2).
"""

from dataclasses import dataclass, replace

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.balancing.criterion import Criterion
from estimator.balancing.least_largest import least_largest
from estimator.balancing.measured_influence import MeasuredInfluence
from estimator.balancing.model_balancing import least_squares_within
from estimator.errors import Invalid
from estimator.updated_model.uncertainty import PhasorBand


class CorrectionUnusable(Invalid):
    """Raised for limits or weights of a correction that have another shape or are negative."""


@dataclass(frozen=True)
class InfluenceCorrection:
    """Unbalances to add to Q planes, and their effect at K measuring points.

    Attributes:
        influence: Coefficients from which the correction was computed.
        criterion: What was minimised.
        weight: Weights to add (Q,) to the state without trial weights [kg m].
        covariance: Covariance (Q, Q) of the weights, E[e eᴴ] [kg² m²]; of those without limits, as if none held.
        before: Vibration (K,) without added weights [m].
        after: Vibration (K,) of the next run, predicted [m].
    """

    influence: MeasuredInfluence
    criterion: Criterion
    weight: Complexes
    covariance: Complexes
    before: PhasorBand
    after: PhasorBand

    @property
    def standard_error(self) -> Floats:
        """Return the standard errors (...) of the weights along any one direction, widened as their intervals [kg m]."""
        return self.influence.widening * np.sqrt(np.maximum(np.real(np.diag(self.covariance)), 0.0) / 2.0)

    def installed(self, weight: Complexes) -> "InfluenceCorrection":
        """Return the prediction for the weights that are really put on.

        Args:
            weight: Weights (Q,) [kg m].

        Returns:
            The correction with them.
        """
        return replace(self, weight=weight, after=self.influence.predicted(weight))


def correct(
    influence: MeasuredInfluence,
    *,
    criterion: Criterion = "least-squares",
    weight: Floats | None = None,
    limit: Floats | None = None,
) -> InfluenceCorrection:
    """Compute the correction that leaves least vibration (Goodman 1964, doi:10.1115/1.3670532).

    Args:
        influence: Influence coefficients and the vibration without added weights.
        criterion: What is to be minimised.
        weight: Weight (K,) of each measuring point; None for 1 everywhere [-].
        limit: Largest correction (Q,) of each plane; None for no limit [kg m].

    Returns:
        The correction, with the vibration before and after it.

    Raises:
        CorrectionUnusable: Weights or limits have another shape or are negative.
        BalancingFailed: No best correction was found within the limits.
    """
    points, planes = influence.influence.shape
    scale = _checked(weight, "weight", points, 1.0)
    limits = _checked(limit, "limit", planes, np.inf)
    matrix, target = influence.influence * scale[:, None], -influence.offset * scale
    # Columns of equal length: the solvers see planes alike.
    length = np.linalg.norm(matrix, axis=0)
    length = np.where(length > 0.0, length, 1.0)
    minimise = least_largest if criterion == "min-max" else least_squares_within
    found = minimise(matrix / length, target, limits * length) / length
    return InfluenceCorrection(
        influence=influence,
        criterion=criterion,
        weight=found,
        covariance=_covariance(influence, found, scale),
        before=influence.predicted(np.zeros(planes, dtype=complex)),
        after=influence.predicted(found),
    )


def _covariance(influence: MeasuredInfluence, found: Complexes, scale: Floats) -> Complexes:
    """Compute the covariance of the correction from the errors of offset and coefficients, first order.

    c = -(AᴴA)⁻¹Aᴴ V0, so dc = -(AᴴA)⁻¹ (Aᴴ (dV0 + dA c) + dAᴴ r) with the residual r.
    """
    matrix = influence.influence * scale[:, None]
    normal = np.linalg.pinv(np.conj(matrix).T @ matrix)
    size = scale * np.sqrt(influence.error_of(found))
    correlation = influence.correlation()
    first = np.conj(matrix).T @ (correlation * np.outer(size, size)) @ matrix
    residual = scale**2 * (influence.offset + influence.influence @ found)
    own = np.sqrt(np.maximum(np.real(np.diag(influence.scatter)), 0.0))
    pull = residual * own
    strength = float(np.real(np.conj(pull) @ correlation @ pull))
    # Points that the same runs show have the same factor, but for their scatter.
    seen = own > 0.0
    factor = influence.spread[seen, 1:, 1:] / (own[seen] ** 2)[:, None, None]
    second = strength * np.conj(np.mean(factor, axis=0)) if seen.any() else 0.0
    return np.asarray(normal @ (first + second) @ normal)


def _checked(values: Floats | None, name: str, count: int, default: float) -> Floats:
    if values is None:
        return np.full(count, default)
    checked = np.asarray(values, dtype=float)
    if checked.shape != (count,) or not np.all(checked >= 0.0):
        raise CorrectionUnusable(f"{name} must hold {count} numbers that are not negative")
    return checked
