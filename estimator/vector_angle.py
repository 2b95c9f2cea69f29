"""Where on the rotor an unbalance lies, and how surely.

The estimate z = v + e of a vector v has an error e with the standard deviation s along each direction. For the angle δ between
estimate and truth, |z| sin δ is the part of e across v, which is normal with s. So |sin δ| ≤ 1.96 s / |z| holds for 95 % of
estimates, and the interval's half width is arcsin(1.96 s / |z|); from |z| = 1.96 s on down every angle is possible.
"""

import numpy as np

from estimator.arrays import Complexes, Floats


def angle_deg(value: Complexes) -> Floats:
    """Angles from the keyphasor mark on, from +x to +y, in [0, 360) [°]. value: (n,); NaN stays NaN."""
    return np.asarray(np.degrees(np.angle(value)) % 360.0 % 360.0)


def angle_half_width_deg(value: Complexes, upper: Floats) -> Floats:
    """Half widths of the 95 % intervals of these angles, 180 where any angle is possible [°].

    value: (n,); upper: (n,) upper bounds of the magnitudes, |value| + 1.96 standard errors, in the same unit.
    """
    size = np.abs(value)
    with np.errstate(divide="ignore", invalid="ignore"):
        part = (upper - size) / size
    half = np.degrees(np.arcsin(np.clip(part, 0.0, 1.0)))
    return np.asarray(np.where(part >= 1.0, 180.0, half))
