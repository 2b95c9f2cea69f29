"""A smooth curve through points, cut where it turns: between two cuts it rises or falls, so crossings are bracketed."""

from dataclasses import dataclass

import numpy as np
import scipy.interpolate
import scipy.optimize

from estimator.arrays import Floats

SAME = 1e-9
"""Turns that lie so near to each other, in units of the points' distance, are one that rounding has doubled."""
PRECISION = 1e-13
"""Relative precision of a crossing."""


@dataclass(frozen=True)
class TurningCurve:
    """A cubic spline. cuts, heights: (K,) its points and turns, ascending, and the curve there. tops: (T,) of the maxima."""

    spline: scipy.interpolate.CubicSpline
    cuts: Floats
    heights: Floats
    tops: Floats

    @classmethod
    def through(cls, place: Floats, height: Floats) -> "TurningCurve":
        """Through points (S,) at ascending places (S,)."""
        spline = scipy.interpolate.CubicSpline(place, height)
        turns = _turns(spline)
        cuts = np.union1d(place, turns)
        return cls(spline, cuts, np.asarray(spline(cuts)), turns[spline(turns, 2) < 0.0])

    def fallen_to(self, level: float, *, start: float, highest: float, upwards: bool) -> float | None:
        """The first place beyond a start at which the curve is down to a level; None where it ends or rises too high before.

        highest: what is too high. start: where the curve is above the level. upwards: whether to look at larger places or at
        smaller ones.
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


def _turns(spline: scipy.interpolate.CubicSpline) -> Floats:
    """Where a spline's slope is zero, ascending."""
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
