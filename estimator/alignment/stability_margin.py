"""Stability margin of a train on its oil films: how well its least damped whirl decays at running speed, with its error.

The limit is that of API 617 (8th ed., 2014, level II stability analysis): a logarithmic decrement of 0.1. The error is to
first order (JCGM 100:2008, 5.2), with the derivatives of the eigenvalue (Nelson 1976, doi:10.2514/3.7211).
"""

from dataclasses import dataclass

import numpy as np

from estimator.fit.validation.physical_limits import PhysicalLimits
from estimator.machine.film_speeds import follows_films, reported_rpm
from estimator.units import rpm_to_rad_per_s
from estimator.updated_model.model import UpdatedModel
from estimator.updated_model.uncertainty import standard_errors

LEAST_DECREMENT = 0.1
"""Logarithmic decrement that a train needs at the speed at which it works [-]."""


@dataclass(frozen=True)
class StabilityMargin:
    """The least damped of the modes that whirl more slowly than the shaft turns.

    Attributes:
        speed: Spin speed, without sign [rad/s].
        frequency: Its damped natural frequency [rad/s].
        log_decrement: Its logarithmic decrement [-].
        error: Standard error of that [-].
    """

    speed: float
    frequency: float
    log_decrement: float
    error: float


def stability_margin(model: UpdatedModel) -> StabilityMargin | None:
    """Compute the stability margin at running speed (Nelson 1976, doi:10.2514/3.7211; JCGM 100:2008, 5.2).

    Args:
        model: The updated model.

    Returns:
        The margin; None of a train whose coefficients do not follow from films, or of which no mode whirls so slowly.
    """
    if not follows_films(model.machine):
        return None
    speed = np.array([rpm_to_rad_per_s(reported_rpm(model.machine)[-1])])
    coordinates = model.coordinates_at(speed)
    theta = coordinates.theta(model.values)
    if not np.isfinite(coordinates.coefficients(theta)).all():
        return None
    limits = PhysicalLimits(model.machine, speed, coordinates, tuple(model.scale_factors))
    mode = next(iter(limits.least_damped_below_speed(theta)), None)
    if mode is None:
        return None
    root, decrement = mode.eigenvalue, mode.log_decrement
    by_root = limits.root_slopes(theta, mode)
    slope = -2.0 * np.pi * by_root.real / root.imag - decrement * by_root.imag / root.imag
    covariance = model.covariance / np.outer(coordinates.unit, coordinates.unit)
    return StabilityMargin(mode.speed, root.imag, decrement, float(standard_errors(slope, covariance)))
