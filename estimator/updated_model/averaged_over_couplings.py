"""Averages of what films carry over the stiffness of couplings that the data leave open.

A load is nearly the product of a coupling's stiffness and of how high bearings stand. Where both are open, its derivatives at
the estimate do not hold over the stiffness's own interval. Value and variance are averaged over three points of the logarithm
of the stiffness, the estimate and √3 standard deviations to either side, with all other numbers as data and prior expect them
there (`expected_at_stiffness`): a Gauss-Hermite rule, exact for polynomials of the fifth degree (Abramowitz and Stegun,
Handbook of Mathematical Functions, 1964, 25.4.46). At each point the other numbers count to first order (JCGM 100:2008, 5.2);
the variance is the mean of those at the points and the variance between them.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import sqrt
from typing import Generic

import numpy as np

from estimator.arrays import Floats
from estimator.symmetric_eigen import symmetric_eigen
from estimator.updated_model.expected_at_stiffness import Expected, ExpectedAtStiffness, FittedNumbers, Prediction, TrainState
from estimator.updated_model.uncertainty import standard_errors

OPEN = 0.2
"""Standard deviation of the logarithm of a stiffness from which on it counts as open [-].

Of a product of a number that is log-normal by σ and one that varies by itself, first order tells a standard error that is too
small by the factor exp(-σ²): 4 % here, with which 94.0 % of 95 % intervals hold. The points would cost three times the time.
"""
DISTANCES = (sqrt(3.0), 1.0)
"""Distances of the points in standard deviations [-]; the shorter where a train has no equilibrium at the longer ones."""


@dataclass(frozen=True)
class Averaged:
    """Numbers that follow from uncertain ones.

    Attributes:
        value: Means (m,) [any unit].
        error: Standard errors (m,) [that unit].
    """

    value: Floats
    error: Floats


@dataclass(frozen=True)
class OverCouplings(Generic[TrainState]):
    """States of a train at its estimate and over the stiffness of its open couplings.

    Attributes:
        fitted: What the fit left known.
        central: TrainState at the estimate.
        lines: For each open principal stiffness the weights of its points [-] and what is expected there.
    """

    fitted: FittedNumbers
    central: TrainState
    lines: tuple[tuple[tuple[float, Expected[TrainState]], ...], ...]

    def averaged(self, predict: Callable[[Floats, TrainState], Prediction]) -> Averaged:
        """Compute a prediction's mean and error over the stiffness that is open (Abramowitz and Stegun, 1964, 25.4.46).

        Several open stiffnesses are taken one at a time; what each adds to the mean and to the variance of first order is
        summed, to the variance nothing less than zero. It is first order where none is open.

        Args:
            predict: Function of all fitted numbers (n,) and of the train's state with them that predicts.

        Returns:
            Means and standard errors.
        """
        central = predict(self.fitted.values, self.central)
        first_order = standard_errors(central.slope, self.fitted.covariance) ** 2
        value, variance = central.value.copy(), first_order.copy()
        for line in self.lines:
            weight = np.array([weight for weight, _ in line])
            found = [predict(one.values, one.state) for _, one in line]
            within = [standard_errors(one.slope, at.covariance) ** 2 for one, (_, at) in zip(found, line, strict=True)]
            values = np.stack([one.value for one in found])
            mean = weight @ values
            value += mean - central.value
            variance += np.maximum(weight @ (np.stack(within) + (values - mean) ** 2) - first_order, 0.0)
        return Averaged(value, np.sqrt(variance))


def over_couplings(
    fitted: FittedNumbers,
    central: TrainState,
    *,
    reach: Callable[[Floats], TrainState | None],
    seen: Callable[[TrainState], Prediction],
) -> OverCouplings[TrainState]:
    """Find a train's states over the stiffness of its open couplings (Abramowitz and Stegun, 1964, 25.4.46).

    Several open stiffnesses are taken along the principal axes of their covariance. One along which there is no equilibrium to
    both sides has no points.

    Args:
        fitted: What the fit left known.
        central: TrainState at the estimate.
        reach: Function of all fitted numbers (n,) that returns the state; None where the train has no equilibrium.
        seen: Function of a state that returns the forces by which data see how high bearings stand.

    Returns:
        The states.
    """
    directions = list(_open_directions(fitted))
    if not directions:
        return OverCouplings(fitted, central, ())
    expected = ExpectedAtStiffness(fitted, central, reach=reach, seen=seen)
    lines = (_points(expected, along) for along in directions)
    return OverCouplings(fitted, central, tuple(line for line in lines if line))


def _open_directions(fitted: FittedNumbers) -> Iterator[Floats]:
    """Yield the direction (r,) of each open principal stiffness among the fit's numbers of unit variance."""
    places = fitted.stiffnesses
    spreads, axes = symmetric_eigen(fitted.covariance[np.ix_(places, places)])
    for spread, axis in zip(spreads.tolist(), axes.T, strict=True):
        if spread > OPEN**2:
            yield fitted.factor[places].T @ axis / sqrt(spread)


def _points(expected: ExpectedAtStiffness[TrainState], along: Floats) -> tuple[tuple[float, Expected[TrainState]], ...]:
    """Return three points of one stiffness with their weights; none where there is no equilibrium to both sides."""
    middle = expected.at(along, 0.0)
    for distance in DISTANCES:
        low, high = expected.at(along, -distance), expected.at(along, distance)
        if middle is not None and low is not None and high is not None:
            beside = 0.5 * distance**-2
            return (1.0 - 2 * beside, middle), (beside, low), (beside, high)
    return ()
