"""Smooth curve through points, cut where it turns: between two cuts it rises or falls, so crossings are bracketed."""

from dataclasses import dataclass

import numpy as np
import scipy

from estimator.arrays import Floats

SAME = 1e-9
"""Distance of two turns, in units of the points' distance, up to which they are one that rounding has doubled [-]."""
PRECISION = 1e-13
"""Relative precision of a crossing [-]."""


@dataclass(frozen=True)
class TurningCurve:
    """A cubic spline with its turns.

    Attributes:
        spline: The spline.
        cuts: Places (K,) of its points and turns, ascending [any unit].
        heights: The curve there (K,) [any unit].
        tops: Places (T,) of its maxima [unit of the places].
    """

    spline: "scipy.interpolate.CubicSpline"
    cuts: Floats
    heights: Floats
    tops: Floats

    @classmethod
    def through(cls, place: Floats, height: Floats) -> "TurningCurve":
        """Lay the curve through points.

        Source: standard result: cubic spline, cut where its slope is zero.

        Args:
            place: Places (S,), ascending [any unit].
            height: Heights (S,) [any unit].

        Returns:
            The curve.
        """
        spline = scipy.interpolate.CubicSpline(place, height)
        turns = _turns(spline)
        cuts = np.union1d(place, turns)
        return cls(spline, cuts, np.asarray(spline(cuts)), turns[spline(turns, 2) < 0.0])

    def first_below(self, level: float, *, start: float, highest: float, upwards: bool) -> float | None:
        """Find the first place beyond a start at which the curve is down to a level.

        Source: standard result: root of a monotone curve between two cuts, by Brent's method.

        Args:
            level: The level [unit of the heights].
            start: Place where the curve is above the level [unit of the places].
            highest: Height that the curve must not exceed before [unit of the heights].
            upwards: Whether larger places are searched, or smaller ones.

        Returns:
            The place [unit of the places]; None where the curve ends or rises too high before.
        """
        beyond = np.flatnonzero(self.cuts > start) if upwards else np.flatnonzero(self.cuts < start)[::-1]
        heights = self.heights[beyond]
        down, over = (np.flatnonzero(found) for found in (heights <= level, heights > highest))
        if not down.size or (over.size and over[0] < down[0]):
            return None
        before = start if down[0] == 0 else float(self.cuts[beyond[down[0] - 1]])
        there = float(self.cuts[beyond[down[0]]])
        crossing = scipy.optimize.brentq(lambda x: float(self.spline(x)) - level, before, there, rtol=PRECISION)
        return float(crossing)


def _turns(spline: "scipy.interpolate.CubicSpline") -> Floats:
    """Find where a spline's slope is zero, ascending."""
    cubic, square, slope, _ = spline.c
    length = np.diff(spline.x)
    a, b, c = 3.0 * cubic, 2.0 * square, slope
    with np.errstate(divide="ignore", invalid="ignore"):
        # The stable form of the roots of a x² + b x + c.
        q = -0.5 * (b + np.copysign(np.sqrt(b**2 - 4.0 * a * c), b))
        roots = np.stack([q / a, c / q])
        inside = (roots >= -SAME * length) & (roots <= (1.0 + SAME) * length)
    piece = np.nonzero(inside)[1]
    found = np.sort(spline.x[piece] + roots[inside])
    apart = np.diff(found) > SAME * float(np.min(length))
    return np.asarray(found[np.concatenate([[True], apart])]) if found.size else found
