"""Viscosity of the oil in a film over the spin speed: as much as the oil warms, or as a power of the speed.

Splines: de Boor, A Practical Guide to Splines, Springer 1978.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy

from estimator.arrays import Floats


@dataclass(frozen=True)
class ViscosityOverSpeed:
    """Viscosity μ(ω) = μ₁ g(ω) (ω/ω₁)⁻ˢ, with g the course that is expected of it and s a slope beside that.

    Attributes:
        value: Viscosity μ₁ at the reference speed [Pa s].
        reference: Reference speed ω₁ [rad/s].
        slope: Slope s: fall of the logarithm of the viscosity with that of the speed [-].
        course: Speeds (S,), ascending [rad/s], and expected viscosities (S,) there [Pa s]; None for the same at all speeds.
    """

    value: float
    reference: float
    slope: float = 0.0
    course: tuple[Floats, Floats] | None = None

    def at(self, speed: Floats | float) -> Floats:
        """Compute the viscosity.

        Source: splines of de Boor, A Practical Guide to Splines, Springer 1978.

        Args:
            speed: Spin speeds (...), without sign [rad/s].

        Returns:
            Viscosities (...) [Pa s].
        """
        logarithm = -self.slope * np.log(np.asarray(speed) / self.reference)
        if self._logarithm is not None:
            logarithm = logarithm + self._logarithm(self._within(speed)) - self._logarithm(self._within(self.reference))
        return np.asarray(self.value * np.exp(logarithm))

    def by_slope(self, speed: Floats | float) -> Floats:
        """Compute the derivative of the logarithm of the viscosity by the slope.

        Args:
            speed: Spin speeds (...), without sign [rad/s].

        Returns:
            Derivatives (...) [-].
        """
        return np.asarray(-np.log(np.asarray(speed) / self.reference))

    def changed(self, *, factor: float, slope: float) -> "ViscosityOverSpeed":
        """Return another viscosity of the same expected course.

        Args:
            factor: Viscosity at the reference speed over this one's [-].
            slope: Slope beside the expected course [-].

        Returns:
            The viscosity.
        """
        return replace(self, value=self.value * factor, slope=slope)

    def _within(self, speed: Floats | float) -> Floats:
        assert self.course is not None
        return np.asarray(np.log(np.clip(speed, self.course[0][0], self.course[0][-1])))

    @cached_property
    def _logarithm(self) -> "scipy.interpolate.CubicSpline | None":
        return None if self.course is None else scipy.interpolate.CubicSpline(np.log(self.course[0]), np.log(self.course[1]))
