"""From fit coordinates to estimates that a person can use: SI values with intervals, or the reason why there is none."""

import math
from dataclasses import dataclass

import numpy as np

from estimator.condensation import Floats
from estimator.coordinates import Coordinates
from estimator.parameters import Coefficient, Quantity, UnbalancePlane, Unknowns

CONFIDENCE_95 = 1.959964
"""Half width of a 95 % interval in standard errors."""
LARGEST_RELATIVE_ERROR = 1.0
"""A cross-coupled term or unbalance whose standard error exceeds this part of its scale is not estimable."""
LARGEST_DIRECT_ERROR = 0.4
"""The same for a direct term and its own value: beyond it the term may be zero, and its logarithm has no sound interval."""


@dataclass(frozen=True)
class Estimate:
    """One estimated parameter, in SI units.

    value, standard_error, lower, upper (95 %): None where the data do not determine it; `reason` then says why. An
    unbalance has an imaginary part and its standard error beside the real one; lower and upper then bound the magnitude.
    """

    name: str
    element: str
    quantity: Quantity
    unit: str
    value: float | None
    standard_error: float | None
    lower: float | None
    upper: float | None
    imaginary: float | None = None
    imaginary_standard_error: float | None = None
    reason: str | None = None

    @property
    def estimable(self) -> bool:
        """Whether the data determine this parameter."""
        return self.value is not None


def estimates(unknown: Unknowns, coordinates: Coordinates, theta: Floats, error: Floats) -> tuple[Estimate, ...]:
    """Estimates of all parameters, from fit coordinates (K + 2P,) and their standard errors."""
    values = coordinates.coefficients(theta)
    # A cross-coupled term is judged by the direct terms beside it; its own value may well be zero.
    size = {c.name: value for c, value in zip(unknown.coefficients, values, strict=True)}
    result = []
    for coefficient, value, spread, scale in zip(unknown.coefficients, values, error, coordinates.scale, strict=False):
        if coefficient.direct:
            result.append(_direct(coefficient, float(value), float(spread)))
        else:
            stem = coefficient.name[:-2]
            beside = math.sqrt(size[f"{stem}xx"] * size[f"{stem}yy"])
            result.append(_cross(coefficient, float(value), float(scale * spread), beside))
    unbalances = coordinates.unbalances(theta)
    spreads = coordinates.unbalance_scale * error[values.size :].reshape(-1, 2)
    largest = float(np.max(np.abs(unbalances)))
    for plane, unbalance, spread in zip(unknown.unbalances, unbalances, spreads, strict=True):
        result.append(_unbalance(plane, complex(unbalance), spread, largest))
    return tuple(result)


def _direct(coefficient: Coefficient, value: float, error: float) -> Estimate:
    """A direct term; `error` is of its logarithm, which makes the interval lopsided."""
    if error > LARGEST_DIRECT_ERROR:
        return _not_estimable(coefficient, f"the data leave it uncertain by {100 * error:.0f} % of its value")
    lower, upper = (value * math.exp(sign * CONFIDENCE_95 * error) for sign in (-1, 1))
    return Estimate(*_common(coefficient), value, value * error, lower, upper)


def _cross(coefficient: Coefficient, value: float, error: float, beside: float) -> Estimate:
    if error > LARGEST_RELATIVE_ERROR * beside:
        reason = f"the data leave it uncertain by {100 * error / beside:.0f} % of the direct terms of its element"
        return _not_estimable(coefficient, reason)
    half = CONFIDENCE_95 * error
    return Estimate(*_common(coefficient), value, error, value - half, value + half)


def _unbalance(plane: UnbalancePlane, value: complex, error: Floats, largest: float) -> Estimate:
    worst = float(np.max(error))
    if worst > LARGEST_RELATIVE_ERROR * largest:
        reason = f"the data leave it uncertain by {worst:.2g} kg m, more than the largest unbalance found"
        return _not_estimable(plane, reason)
    half = CONFIDENCE_95 * worst
    return Estimate(
        *_common(plane),
        value=value.real,
        standard_error=float(error[0]),
        lower=max(0.0, abs(value) - half),
        upper=abs(value) + half,
        imaginary=value.imag,
        imaginary_standard_error=float(error[1]),
    )


def _not_estimable(item: Coefficient | UnbalancePlane, reason: str) -> Estimate:
    return Estimate(*_common(item), None, None, None, None, reason=reason)


def _common(item: Coefficient | UnbalancePlane) -> tuple[str, str, Quantity, str]:
    quantity: Quantity = item.quantity if isinstance(item, Coefficient) else "unbalance"
    return item.name, item.element, quantity, item.unit
