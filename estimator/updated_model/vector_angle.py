"""Angle of an unbalance on the rotor, and its uncertainty.

The estimate z = v + e of a vector v has an error e with the standard deviation s along each direction. For the angle δ between
estimate and truth, |z| sin δ is the part of e across v, which is normal with s. So |sin δ| ≤ 1.96 s / |z| holds for 95 % of
estimates, and the interval's half width is arcsin(1.96 s / |z|); from |z| = 1.96 s on down every angle is possible.
"""

import numpy as np

from estimator.arrays import Complexes, Floats


def angle_deg(value: Complexes) -> Floats:
    """Compute angles from the keyphasor mark on, from +x to +y, in [0, 360).

    Args:
        value: Vectors (n,) [any unit]; NaN stays NaN.

    Returns:
        Angles (n,) [°].
    """
    return np.asarray(np.degrees(np.angle(value)) % 360.0 % 360.0)


def angle_half_width_deg(value: Complexes, upper: Floats) -> Floats:
    """Compute the half widths of the 95 % intervals of these angles.

    Args:
        value: Vectors (n,) [any unit].
        upper: Upper bounds (n,) of the magnitudes, |value| + 1.96 standard errors [unit of the vectors].

    Returns:
        Half widths (n,), 180 where any angle is possible [°].
    """
    size = np.abs(value)
    with np.errstate(divide="ignore", invalid="ignore"):
        part = (upper - size) / size
    half = np.degrees(np.arcsin(np.clip(part, 0.0, 1.0)))
    return np.asarray(np.where(part >= 1.0, 180.0, half))
