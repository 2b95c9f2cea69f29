"""Upper bound of the logarithm of the scatter's determinant: what counts beside χ² while a pass of a calibration descends.

The logarithm grows with that of the gains' sizes. A straight line through the present gains has no end: where the weights
tell the gains poorly, it leads through zero to gains of the opposite sign, and from pass to pass to and fro. In place of it
each gain's size itself counts, for log x <= x - 1: the bound touches the logarithm at the present gains, is convex and ends at
zero (majorisation; Hunter and Lange, Am. Stat. 58 (2004) 30, doi:10.1198/0003130042836). In all other coordinates it is the
straight line.
"""

from typing import Self

import numpy as np
from msgspec import Struct

from estimator.arrays import Floats
from estimator.fit.problem.channel_coordinates import ChannelCoordinates

LEAST_SIZE = 1e-12
"""Size of a gain beneath which it counts as zero [-]."""


class DeterminantBound(Struct, frozen=True, eq=False):
    """Bound of a determinant's logarithm over n fit coordinates, with m channels.

    Attributes:
        slope: Derivative (n,) of its straight part [-].
        growth: Derivative (m,) by the size of each channel's gain [-].
        channels: Gains among the coordinates.
    """

    slope: Floats
    growth: Floats
    channels: ChannelCoordinates

    @classmethod
    def through(cls, theta: Floats, slope: Floats, channels: ChannelCoordinates) -> Self:
        """Build the bound that touches the logarithm at a point.

        Args:
            theta: Fit coordinates θ (n,) of the point [-].
            slope: Derivative (n,) of the logarithm there [-].
            channels: Gains among the coordinates.

        Returns:
            The bound.
        """
        gains, straight, growth = channels.gains(theta), slope.copy(), np.zeros(channels.gain.size)
        for channel in np.flatnonzero(channels.gain >= 0):
            pair, unit, size = _pair(channels, channel), channels.unit[channels.gain[channel]], abs(gains[channel])
            if size < LEAST_SIZE:
                continue
            outward = np.array([gains[channel].real, gains[channel].imag]) / size
            growth[channel] = max(0.0, float(slope[pair] @ outward) / unit)
            straight[pair] -= growth[channel] * unit * outward
        return cls(straight, growth, channels)

    def value(self, theta: Floats) -> float:
        """Compute the bound, but for a constant.

        Args:
            theta: Fit coordinates θ (n,) [-].

        Returns:
            The bound [-].
        """
        return float(self.slope @ theta + self.growth @ np.abs(self.channels.gains(theta)))

    def derivatives(self, theta: Floats) -> tuple[Floats, Floats]:
        """Compute the bound's derivatives.

        Args:
            theta: Fit coordinates θ (n,) [-].

        Returns:
            Gradient (n,) and second derivatives (n, n) [-].
        """
        gradient, curvature = self.slope.copy(), np.zeros((theta.size, theta.size))
        gains = self.channels.gains(theta)
        for channel in np.flatnonzero(self.growth > 0.0):
            pair, unit = _pair(self.channels, channel), self.channels.unit[self.channels.gain[channel]]
            size = max(abs(gains[channel]), LEAST_SIZE)
            outward = np.array([gains[channel].real, gains[channel].imag]) / size
            gradient[pair] += self.growth[channel] * unit * outward
            # A size grows straight outward, and bends across.
            across = np.array([-outward[1], outward[0]])
            curvature[np.ix_(pair, pair)] += self.growth[channel] * unit**2 / size * np.outer(across, across)
        return gradient, curvature


def _pair(channels: ChannelCoordinates, channel: np.intp) -> list[int]:
    return [int(channels.gain[channel]), int(channels.gain[channel]) + 1]
