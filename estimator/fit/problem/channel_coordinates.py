"""Coordinates of measuring chains: gains and run-outs of channels, and readings made of phasors with them."""

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats


class ChannelCoordinates(Struct, frozen=True, eq=False):
    """Gains and run-outs of m channels among the coordinates θ (n,) of a fit.

    Attributes:
        gain: First coordinate of each channel's gain (m,); -1 where it is taken as exact.
        run_out: First coordinate of each channel's run-out (m,); -1 where it is taken as exact.
        unit: Unit (n,) of all coordinates [SI].
    """

    gain: NDArray[np.intp]
    run_out: NDArray[np.intp]
    unit: Floats

    @property
    def count(self) -> int:
        """Return the number of coordinates that belong to channels, which a prior keeps small."""
        return self.places.size

    @property
    def places(self) -> NDArray[np.intp]:
        """Return the coordinates (c,) that belong to channels."""
        first = np.concatenate([self.gain[self.gain >= 0], self.run_out[self.run_out >= 0]])
        return np.concatenate([first, first + 1])

    def gains(self, theta: Floats) -> Complexes:
        """Compute the gain of each channel: measured over true.

        Args:
            theta: Fit coordinates θ (n,) [-].

        Returns:
            Gains (m,) [-].
        """
        return np.asarray(1.0 + self._values(theta, self.gain))

    def run_outs(self, theta: Floats) -> Complexes:
        """Compute the run-out of each channel in rotation from +x to +y.

        Args:
            theta: Fit coordinates θ (n,) [-].

        Returns:
            Run-outs (m,) [m].
        """
        return self._values(theta, self.run_out)

    def as_measured(self, theta: Floats, phasor: Complexes, direction: Floats) -> Complexes:
        """Convert phasors to readings, through the channels' gains and with run-out.

        Run-out is a pattern on the shaft, so it is mirrored with the rotation.

        Args:
            theta: Fit coordinates θ (n,) [-].
            phasor: Phasors at the probes (S, m) [m].
            direction: Sense of rotation (S,), +1 or -1 [-].

        Returns:
            Readings (S, m) [m].
        """
        run_out = self.run_outs(theta)
        turned = np.where(direction[:, None] > 0, run_out, np.conj(run_out))
        return np.asarray(phasor * self.gains(theta) + turned)

    def add_derivatives(self, derivatives: Complexes, phasor: Complexes, direction: Floats) -> None:
        """Add the derivatives of readings by gains and run-outs to those by other coordinates.

        Args:
            derivatives: Derivatives by all coordinates (n, S, m) [m], which are changed.
            phasor: Phasors at the probes (S, m) [m].
            direction: Sense of rotation (S,), +1 or -1 [-].
        """
        for channel in np.flatnonzero(self.gain >= 0):
            first = self.gain[channel]
            derivatives[first, :, channel] = self.unit[first] * phasor[:, channel]
            derivatives[first + 1, :, channel] = 1j * self.unit[first] * phasor[:, channel]
        for channel in np.flatnonzero(self.run_out >= 0):
            first = self.run_out[channel]
            derivatives[first, :, channel] = self.unit[first]
            derivatives[first + 1, :, channel] = 1j * self.unit[first] * direction

    def _values(self, theta: Floats, place: NDArray[np.intp]) -> Complexes:
        """Compute complex values at the coordinates (m,) of their real parts, zero where the place is -1."""
        found = np.zeros(place.size, dtype=complex)
        first = place[place >= 0]
        found[place >= 0] = self.unit[first] * (theta[first] + 1j * theta[first + 1])
        return found
