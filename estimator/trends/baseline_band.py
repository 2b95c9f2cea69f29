"""Prediction bands: the range in which the next run's estimate of a parameter lies while nothing happens to the machine.

Prediction interval of one further observation (Hahn and Meeker, Statistical Intervals, Wiley 1991).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.special

from estimator.arrays import Complexes, Floats
from estimator.machine.parameter_description import COMPONENTS, is_direct
from estimator.trends.between_run_scatter import between_run_scatter
from estimator.trends.parameter_vector import Point

QUANTILE = 0.975
"""Quantile of Student's t for a two-sided band of 95 % [-]."""


@dataclass(frozen=True)
class Band:
    """Prediction band of the next run's estimate.

    Attributes:
        centre: Mean of the baseline [SI unit of the parameter].
        lower: Lower end of the band that holds 95 % of the next runs' estimates [SI unit of the parameter].
        upper: Upper end of that band [SI unit of the parameter].
    """

    centre: float
    lower: float
    upper: float


def baseline_band(name: str, value: Floats, error: Floats) -> Band:
    """Compute the band of a real parameter or derived quantity from the estimates of n runs.

    The scatter from run to run is the baseline's own, shrunk towards what is usual (`between_run_scatter`); added are the
    error of one fit, as the baseline's fits have it, and the uncertainty of the mean of n. Direct terms are judged as
    logarithms.

    Source: Hahn and Meeker, Statistical Intervals, Wiley 1991.

    Args:
        name: Name of the parameter.
        value: Estimates (n,) in the parameter's unit [SI].
        error: Standard errors (n,) in the parameter's unit [SI].

    Returns:
        Band in the parameter's unit [SI].

    Raises:
        ValueError: The baseline is empty.
    """
    if is_direct(name):
        centre, half = _interval(
            [Point((name,), np.log([v]), np.array([[(e / v) ** 2]])) for v, e in zip(value, error, strict=True)]
        )
        return Band(math.exp(centre[0]), math.exp(centre[0] - half[0]), math.exp(centre[0] + half[0]))
    centre, half = _interval([Point((name,), np.array([v]), np.array([[e**2]])) for v, e in zip(value, error, strict=True)])
    return Band(float(centre[0]), float(centre[0] - half[0]), float(centre[0] + half[0]))


def magnitude_band(name: str, value: Complexes, error: Complexes) -> Band:
    """Compute the band of an unbalance's magnitude from the estimates of n runs.

    Source: Hahn and Meeker, Statistical Intervals, Wiley 1991.

    Args:
        name: Name of the excitation.
        value: Complex estimates (n,) in the excitation's unit [SI].
        error: Standard errors (n,) of real and imaginary part in the excitation's unit [SI].

    Returns:
        Band of the magnitude in the excitation's unit [SI].

    Raises:
        ValueError: The baseline is empty.
    """
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
    """Compute mean and half width (N,) of the prediction interval of another run."""
    scatter = between_run_scatter(points)
    own = np.mean([np.diag(point.covariance) for point in points], axis=0)
    spread = np.sqrt((scatter.variance + own) * (1.0 + 1.0 / len(points)))
    half = scipy.special.stdtrit(scatter.degrees_of_freedom, QUANTILE) * spread
    return np.mean([point.value for point in points], axis=0), np.asarray(half)
