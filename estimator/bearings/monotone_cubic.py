"""Shape-preserving cubic interpolation, in numpy alone: documents are read where samples are stored, without scipy."""

import numpy as np

from estimator.arrays import Floats


class MonotoneCubic:
    """Cubics that are monotone between points that are (Fritsch and Carlson, SIAM J. Numer. Anal. 17 (1980) 238).

    Slopes inside are weighted harmonic means of those beside (Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300,
    doi:10.1137/0905021), at the ends of three points.
    """

    def __init__(self, place: Floats, values: Floats) -> None:
        """Compute the slopes.

        Args:
            place: Ascending places (n,), at least three [any unit].
            values: Values (n, C) there [any unit].
        """
        self._place, self._values = place, values
        step = np.diff(place)[:, None]
        secant = np.diff(values, axis=0) / step
        before, after = secant[:-1], secant[1:]
        first, second = 2.0 * step[1:] + step[:-1], step[1:] + 2.0 * step[:-1]
        alike = before * after > 0.0
        weighted = first / np.where(alike, before, 1.0) + second / np.where(alike, after, 1.0)
        inside = np.where(alike, (first + second) / np.where(alike, weighted, 1.0), 0.0)
        ends = [_end_slope(step[0], step[1], secant[0], secant[1]), _end_slope(step[-1], step[-2], secant[-1], secant[-2])]
        self._slope = np.concatenate([ends[0][None], inside, ends[1][None]])

    def __call__(self, place: Floats) -> Floats:
        """Compute values between the points (Hermite cubics).

        Args:
            place: Places (S,) within the ends [unit of the points' places].

        Returns:
            Values (S, C) [unit of the points' values].
        """
        left = np.clip(np.searchsorted(self._place, place, side="right") - 1, 0, self._place.size - 2)
        width = self._place[left + 1] - self._place[left]
        t, h = ((place - self._place[left]) / width)[:, None], width[:, None]
        low, high = self._values[left], self._values[left + 1]
        leaving, arriving = self._slope[left], self._slope[left + 1]
        return np.asarray(
            low * (1.0 + 2.0 * t) * (1.0 - t) ** 2
            + high * t**2 * (3.0 - 2.0 * t)
            + h * (leaving * t * (1.0 - t) ** 2 - arriving * t**2 * (1.0 - t))
        )


def _end_slope(own: Floats, next_: Floats, secant: Floats, beside: Floats) -> Floats:
    """Return the slope at an end from its two intervals, kept within what leaves the shape."""
    slope = ((2.0 * own + next_) * secant - own * beside) / (own + next_)
    slope = np.where(slope * secant <= 0.0, 0.0, slope)
    return np.where((secant * beside <= 0.0) & (np.abs(slope) > 3.0 * np.abs(secant)), 3.0 * secant, slope)
