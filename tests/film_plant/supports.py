"""Bearings of a plant that are no films: rolling elements, or a maker's table, beside others on films.

The force on the journal is that at which the train was aligned, less stiffness times the way from there; from speed to speed
coefficients follow a cubic spline, not the estimator's.
"""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from tests.film_plant.arrays import Floats

ROLLING_WAY = (4e-6, 15e-6)
"""Way by which a load sinks into rolling elements [m]."""
ROLLING_DAMPING, TABLE_DAMPING = (0.1, 0.3), (0.5, 1.2)
"""Damping times the highest speed over the stiffness [-]: rolling elements in damped seats; a film."""
ROLLING_CROSS, TABLE_CROSS = 0.05, 0.2
"""Cross-coupled stiffness over the direct one, rms and largest [-]."""
TABLE_SPEEDS = 13
"""Speeds of a maker's table."""


@dataclass(frozen=True)
class OwnCoefficients:
    """Coefficients of a bearing that is no film, over speed.

    Attributes:
        speed: Speeds (m,), ascending; one of coefficients that are constant [rad/s].
        stiffness: (m, 2, 2) [N/m].
        damping: (m, 2, 2) [N s/m].
    """

    speed: Floats
    stiffness: Floats
    damping: Floats

    @property
    def constant(self) -> bool:
        """Return whether the coefficients are the same at every speed."""
        return self.speed.size == 1

    def at(self, speed: float) -> tuple[Floats, Floats]:
        """Stiffness and damping (2, 2) at a speed [rad/s]."""
        if self.constant:
            return self.stiffness[0], self.damping[0]
        inside = float(np.clip(speed, self.speed[0], self.speed[-1]))
        return CubicSpline(self.speed, self.stiffness)(inside), CubicSpline(self.speed, self.damping)(inside)

    def scaled(self, factors: Floats) -> "OwnCoefficients":
        """The same with factors on kxx, kyy, cxx and cyy (4,) [-]; cross-coupled terms go with the mean of both."""
        roots = np.sqrt(factors)
        return OwnCoefficients(
            self.speed, self.stiffness * np.outer(roots[:2], roots[:2]), self.damping * np.outer(roots[2:], roots[2:])
        )


def rolling(load: float, fastest: float, rng: np.random.Generator) -> OwnCoefficients:
    """Draw constant coefficients of rolling elements under a load [N], of a shaft that turns at most so fast [rad/s]."""
    kyy = load / rng.uniform(*ROLLING_WAY)
    kxx = kyy * rng.uniform(0.5, 0.95)
    damping = np.diag([kxx, kyy]) * rng.uniform(*ROLLING_DAMPING) / fastest
    cross = ROLLING_CROSS * kxx * rng.standard_normal(2)
    return OwnCoefficients(np.zeros(1), np.array([[[kxx, cross[0]], [cross[1], kyy]]]), damping[None])


def tabulated(load: float, slowest: float, fastest: float, rng: np.random.Generator) -> OwnCoefficients:
    """Draw a maker's table under a load [N], between two speeds [rad/s]: softer and less damped the faster it turns."""
    speed = np.linspace(0.9 * slowest, 1.1 * fastest, TABLE_SPEEDS)
    part = (speed / fastest)[:, None, None]
    kyy = load / rng.uniform(2.0, 4.0) / ROLLING_WAY[0]
    kxx = kyy * rng.uniform(0.5, 0.9)
    cross = kxx * rng.uniform(0.0, TABLE_CROSS)
    stiffness = np.array([[kxx, cross], [-cross, kyy]]) * part ** rng.uniform(-0.4, 0.2)
    damping = np.diag([kxx, kyy]) * rng.uniform(*TABLE_DAMPING) / fastest * part ** rng.uniform(-0.9, -0.4)
    return OwnCoefficients(speed, stiffness, damping)
