"""Speed of a shaft as a smooth function of time, from the speeds at some instants."""

from dataclasses import dataclass

import numpy as np
import scipy.interpolate

from estimator.arrays import Floats

SAMPLES_PER_KNOT = 8
"""Samples that a piece of a smooth curve through noisy speeds stands for."""


@dataclass(frozen=True)
class SpeedLaw:
    """Angle of a shaft over time; speed and acceleration are its derivatives. Counted positive in the sense of rotation.

    begin, end: instants between which it is known [s].
    """

    begin: float
    end: float
    _angle: scipy.interpolate.PPoly

    @classmethod
    def through(cls, time: Floats, speed: Floats) -> "SpeedLaw":
        """The monotone cubic through speeds (S,) [rad/s] at instants (S,) [s], ascending; two or more."""
        _require(time, speed)
        curve = scipy.interpolate.PchipInterpolator(time, speed)
        return cls(float(time[0]), float(time[-1]), curve.antiderivative())

    @classmethod
    def measured(cls, time: Floats, speed: Floats) -> "SpeedLaw":
        """The cubic spline nearest to noisy speeds that has a knot at every few samples."""
        _require(time, speed)
        inner = time[SAMPLES_PER_KNOT:-SAMPLES_PER_KNOT:SAMPLES_PER_KNOT]
        if not inner.size:
            return cls.through(time, speed)
        knots = np.concatenate([np.repeat(time[0], 4), inner, np.repeat(time[-1], 4)])
        spline = scipy.interpolate.make_lsq_spline(time, speed, knots, k=3)
        angle = scipy.interpolate.PPoly.from_spline(spline.antiderivative().tck)
        return cls(float(time[0]), float(time[-1]), angle)

    def angle(self, time: Floats) -> Floats:
        """[rad], zero at the beginning."""
        return np.asarray(self._angle(time))

    def speed(self, time: Floats) -> Floats:
        """[rad/s]."""
        return np.asarray(self._angle(time, 1))

    def acceleration(self, time: Floats) -> Floats:
        """[rad/s²]."""
        return np.asarray(self._angle(time, 2))


def _require(time: Floats, speed: Floats) -> None:
    if time.shape != speed.shape or time.ndim != 1 or time.size < 2:
        raise ValueError(f"time {time.shape} and speed {speed.shape} must be equally long, two samples at least")
    if not np.all(np.isfinite(time) & np.isfinite(speed)) or np.any(np.diff(time) <= 0.0):
        raise ValueError("times must be finite and ascending, speeds finite")
