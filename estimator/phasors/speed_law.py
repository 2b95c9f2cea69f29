"""Speed of a shaft as a smooth function of time, from the speeds at some instants."""

import numpy as np
import scipy
from msgspec import Struct
from numpy.typing import NDArray

from estimator.arrays import Floats
from estimator.phasors.least_squares_spline import least_squares_spline

SAMPLES_PER_KNOT = 8
"""Number of samples that a piece of a smooth curve through noisy speeds stands for."""


class SpeedLaw(Struct, frozen=True, eq=False):
    """Angle of a shaft over time, positive in the sense of rotation; speed and acceleration are its derivatives.

    Attributes:
        begin: First instant at which it is known [s].
        end: Last instant at which it is known [s].
    """

    begin: float
    end: float
    _begins: Floats
    _cubics: Floats
    _angles: Floats

    @classmethod
    def of_cubics(cls, begins: Floats, cubics: Floats, *, end: float) -> "SpeedLaw":
        """Return the law of a speed that is cubic piece by piece.

        Args:
            begins: Beginnings (n,) of the pieces, ascending [s].
            cubics: Coefficients (4, n) of powers 3 to 0 of the time since then [rad/s⁴ to rad/s].
            end: Last instant [s].

        Returns:
            The speed law.
        """
        length = np.diff(begins)
        turned = np.cumsum(_integral(cubics[:, :-1], length))
        return cls(float(begins[0]), end, begins, cubics, np.concatenate([[0.0], turned]))

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
        return cls.of_cubics(time[:-1], np.asarray(curve.c), end=float(time[-1]))

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
        return cls.of_cubics(*least_squares_spline(time, speed, inner=inner), end=float(time[-1]))

    def angle(self, time: Floats) -> Floats:
        """Compute the angle, zero at the beginning.

        Args:
            time: Instants (...), of any shape [s].

        Returns:
            Angles (...) [rad].
        """
        which, since = self._place(time)
        return self._angles[which] + _integral(self._cubics[:, which], since)

    def speed(self, time: Floats) -> Floats:
        """Compute the speed.

        Args:
            time: Instants (...), of any shape [s].

        Returns:
            Speeds (...) [rad/s].
        """
        which, since = self._place(time)
        third, second, first, constant = self._cubics[:, which]
        return np.asarray(((third * since + second) * since + first) * since + constant)

    def acceleration(self, time: Floats) -> Floats:
        """Compute the acceleration.

        Args:
            time: Instants (...), of any shape [s].

        Returns:
            Accelerations (...) [rad/s²].
        """
        which, since = self._place(time)
        third, second, first, _ = self._cubics[:, which]
        return np.asarray((3.0 * third * since + 2.0 * second) * since + first)

    def _place(self, time: Floats) -> tuple[NDArray[np.intp], Floats]:
        """Return the piece in which each instant lies, the outer ones beyond the ends, and the time since it began [s]."""
        which = np.clip(np.searchsorted(self._begins, time, side="right") - 1, 0, self._begins.size - 1)
        return which, time - self._begins[which]


def _integral(cubics: Floats, since: Floats) -> Floats:
    third, second, first, constant = cubics
    return np.asarray((((third / 4.0 * since + second / 3.0) * since + first / 2.0) * since + constant) * since)


def _require(time: Floats, speed: Floats) -> None:
    if time.shape != speed.shape or time.ndim != 1 or time.size < 2:
        raise ValueError(f"time {time.shape} and speed {speed.shape} must be equally long, two samples at least")
    if not np.all(np.isfinite(time) & np.isfinite(speed)) or np.any(np.diff(time) <= 0.0):
        raise ValueError("times must be finite and ascending, speeds finite")
