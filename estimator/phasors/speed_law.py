"""Speed of a shaft as a smooth function of time, from the speeds at some instants."""

import numpy as np
import scipy
from msgspec import Struct

from estimator.arrays import Floats

SAMPLES_PER_KNOT = 8
"""Number of samples that a piece of a smooth curve through noisy speeds stands for."""


class SpeedLaw(Struct, frozen=True):
    """Angle of a shaft over time, positive in the sense of rotation; speed and acceleration are its derivatives.

    Attributes:
        begin: First instant at which it is known [s].
        end: Last instant at which it is known [s].
    """

    begin: float
    end: float
    _angle: "scipy.interpolate.PPoly"

    @classmethod
    def through(cls, time: Floats, speed: Floats) -> "SpeedLaw":
        """Lay the monotone cubic through speeds (Fritsch and Butland 1984, doi:10.1137/0905021).

        Args:
            time: Instants (S,), ascending, two or more [s].
            speed: Speeds (S,) [rad/s].

        Returns:
            The speed law.

        Raises:
            ValueError: Times or speeds are not finite, not equally many, or the times do not ascend.
        """
        _require(time, speed)
        curve = scipy.interpolate.PchipInterpolator(time, speed)
        return cls(float(time[0]), float(time[-1]), curve.antiderivative())

    @classmethod
    def measured(cls, time: Floats, speed: Floats) -> "SpeedLaw":
        """Fit the nearest cubic spline with a knot at every few samples to noisy speeds.

        Least-squares splines: de Boor, A Practical Guide to Splines, Springer 1978.

        Args:
            time: Instants (S,), ascending, two or more [s].
            speed: Speeds (S,) [rad/s].

        Returns:
            The speed law.

        Raises:
            ValueError: Times or speeds are not finite, not equally many, or the times do not ascend.
        """
        _require(time, speed)
        inner = time[SAMPLES_PER_KNOT:-SAMPLES_PER_KNOT:SAMPLES_PER_KNOT]
        if not inner.size:
            return cls.through(time, speed)
        knots = np.concatenate([np.repeat(time[0], 4), inner, np.repeat(time[-1], 4)])
        spline = scipy.interpolate.make_lsq_spline(time, speed, knots, k=3)
        angle = scipy.interpolate.PPoly.from_spline(spline.antiderivative().tck)
        return cls(float(time[0]), float(time[-1]), angle)

    def angle(self, time: Floats) -> Floats:
        """Compute the angle, zero at the beginning.

        Args:
            time: Instants (...), of any shape [s].

        Returns:
            Angles (...) [rad].
        """
        return np.asarray(self._angle(time))

    def speed(self, time: Floats) -> Floats:
        """Compute the speed.

        Args:
            time: Instants (...), of any shape [s].

        Returns:
            Speeds (...) [rad/s].
        """
        return np.asarray(self._angle(time, 1))

    def acceleration(self, time: Floats) -> Floats:
        """Compute the acceleration.

        Args:
            time: Instants (...), of any shape [s].

        Returns:
            Accelerations (...) [rad/s²].
        """
        return np.asarray(self._angle(time, 2))


def _require(time: Floats, speed: Floats) -> None:
    if time.shape != speed.shape or time.ndim != 1 or time.size < 2:
        raise ValueError(f"time {time.shape} and speed {speed.shape} must be equally long, two samples at least")
    if not np.all(np.isfinite(time) & np.isfinite(speed)) or np.any(np.diff(time) <= 0.0):
        raise ValueError("times must be finite and ascending, speeds finite")
