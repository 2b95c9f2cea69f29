"""Averages of what films carry over the stiffness of couplings that the data leave open.

A load is nearly the product of a coupling's stiffness and of how high bearings stand. Where both are open, its derivatives at
the estimate do not hold over the stiffness's own interval. Value and variance are averaged over three points of the logarithm
of the stiffness, the estimate and √3 standard deviations to either side, with all other numbers as expected there: a
Gauss-Hermite rule, exact for polynomials of the fifth degree (Abramowitz and Stegun, Handbook of Mathematical Functions, 1964,
25.4.46). At each point the other numbers count to first order (JCGM 100:2008, 5.2); the variance is the mean of those at the
points and the variance between them.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from math import sqrt

import numpy as np

from estimator.arrays import Floats
from estimator.machine.parameter_description import describe
from estimator.updated_model.uncertainty import standard_errors

OPEN = 0.2
"""Standard deviation of the logarithm of a stiffness from which on it counts as open [-].

Of a product of a number that is log-normal by σ and one that varies by itself, first order tells a standard error that is too
small by the factor exp(-σ²): 4 % here, with which 94.0 % of 95 % intervals hold. The points would cost three times the time.
"""
DISTANCES = (sqrt(3.0), 1.0)
"""Distances of the points in standard deviations [-]; the shorter where a train has no equilibrium at the longer ones."""


@dataclass(frozen=True)
class Prediction:
    """Numbers that follow from the fitted ones.

    Attributes:
        value: Values (m,) [any unit].
        slope: Derivatives (m, P) of them by the fitted numbers [that unit].
    """

    value: Floats
    slope: Floats


@dataclass(frozen=True)
class Averaged:
    """Numbers that follow from uncertain ones.

    Attributes:
        value: Means (m,) [any unit].
        error: Standard errors (m,) [that unit].
    """

    value: Floats
    error: Floats


Predict = Callable[[Floats], Prediction | None]
"""Function of the fitted numbers (P,) that predicts; None where a train has no equilibrium."""


def averaged_over_couplings(
    predict: Predict, central: Prediction, *, names: Sequence[str], fitted: Floats, covariance: Floats
) -> Averaged:
    """Compute a prediction's mean and error over couplings' stiffness that is open (Abramowitz and Stegun, 1964, 25.4.46).

    Several open stiffnesses are taken along the principal axes of their covariance, one at a time; what each adds to the mean
    and to the variance of first order is summed, to the variance nothing less than zero. It is first order where none is open,
    or where there is no equilibrium to both sides.

    Args:
        predict: Function of all fitted numbers, of which the first P are those of the covariance.
        central: What it predicts at the estimate.
        names: Names of the P numbers; those of couplings are logarithms of stiffnesses.
        fitted: The estimate (n,), P numbers first [-].
        covariance: Covariance (P, P) [-].

    Returns:
        Means and standard errors.
    """
    first_order = standard_errors(central.slope, covariance) ** 2
    value, variance = central.value.copy(), first_order.copy()
    for along in _open_directions(names, covariance):
        found = _over_points(predict, central, fitted=fitted, along=along, covariance=covariance)
        if found is not None:
            value += found[0] - central.value
            variance += np.maximum(found[1] - first_order, 0.0)
    return Averaged(value, np.sqrt(variance))


def _open_directions(names: Sequence[str], covariance: Floats) -> Iterator[Floats]:
    """Yield the expected change (P,) of all numbers with one standard deviation of each open principal stiffness."""
    places = [place for place, name in enumerate(names) if describe(name).element_kind == "coupling"]
    spreads, axes = np.linalg.eigh(covariance[np.ix_(places, places)])
    for spread, axis in zip(spreads.tolist(), axes.T, strict=True):
        if spread > OPEN**2:
            yield covariance[:, places] @ axis / sqrt(spread)


def _over_points(
    predict: Predict, central: Prediction, *, fitted: Floats, along: Floats, covariance: Floats
) -> tuple[Floats, Floats] | None:
    """Return mean and variance over three points of one stiffness; None where no two of them have an equilibrium."""
    rest = covariance - np.outer(along, along)
    for distance in DISTANCES:
        sides = [predict(_moved(fitted, sign * distance * along)) for sign in (-1.0, 1.0)]
        points = [central, *(one for one in sides if one is not None)]
        if len(points) == 1 + len(sides):
            weight = np.array([1.0 - distance**-2, 0.5 * distance**-2, 0.5 * distance**-2])
            values = np.stack([one.value for one in points])
            within = np.stack([np.sum((one.slope @ rest) * one.slope, axis=-1) for one in points])
            mean = weight @ values
            return mean, weight @ (within + (values - mean) ** 2)
    return None


def _moved(fitted: Floats, by: Floats) -> Floats:
    return np.concatenate([fitted[: by.size] + by, fitted[by.size :]])
