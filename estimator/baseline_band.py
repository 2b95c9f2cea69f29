"""Between which values the next run's estimate of a parameter lies, as long as nothing happens to the machine."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.special

from estimator.arrays import Complexes, Floats
from estimator.between_run_scatter import between_run_scatter
from estimator.parameter_description import COMPONENTS, is_direct
from estimator.point import Point

QUANTILE = 0.975


@dataclass(frozen=True)
class Band:
    """centre: mean of the baseline. lower, upper: between them lie 95 % of the next runs' estimates. SI."""

    centre: float
    lower: float
    upper: float


def baseline_band(name: str, value: Floats, error: Floats) -> Band:
    """Band of a real parameter or derived quantity from n runs' estimates (n,) and their standard errors (n,), SI.

    The scatter from run to run is the baseline's own, shrunk towards what is usual (`between_run_scatter`); to it comes the
    error of a fit as the baseline's have it, and what the mean of n does not know. Direct terms are judged as logarithms.
    Raises ValueError for an empty baseline.
    """
    if is_direct(name):
        centre, half = _interval(
            [Point((name,), np.log([v]), np.array([[(e / v) ** 2]])) for v, e in zip(value, error, strict=True)]
        )
        return Band(math.exp(centre[0]), math.exp(centre[0] - half[0]), math.exp(centre[0] + half[0]))
    centre, half = _interval([Point((name,), np.array([v]), np.array([[e**2]])) for v, e in zip(value, error, strict=True)])
    return Band(float(centre[0]), float(centre[0] - half[0]), float(centre[0] + half[0]))


def magnitude_band(name: str, value: Complexes, error: Complexes) -> Band:
    """The same for the magnitude of an unbalance: value (n,) complex, error (n,) of its real and imaginary part."""
    names = tuple(f"{name}.{part}" for part in COMPONENTS)
    points = [
        Point(names, np.array([v.real, v.imag]), np.diag([e.real**2, e.imag**2])) for v, e in zip(value, error, strict=True)
    ]
    centre, half = _interval(points)
    size = float(np.hypot(*centre))
    along = centre / size if size > 0.0 else np.sqrt([0.5, 0.5])
    width = float(np.sqrt(np.sum((along * half) ** 2)))
    return Band(size, max(0.0, size - width), size + width)


def _interval(points: Sequence[Point]) -> tuple[Floats, Floats]:
    """Mean and half width (N,) of the prediction interval of another run."""
    scatter = between_run_scatter(points)
    own = np.mean([np.diag(point.covariance) for point in points], axis=0)
    spread = np.sqrt((scatter.variance + own) * (1.0 + 1.0 / len(points)))
    half = scipy.special.stdtrit(scatter.degrees_of_freedom, QUANTILE) * spread
    return np.mean([point.value for point in points], axis=0), np.asarray(half)
