"""Proportional (Rayleigh) damping C = αM + βK of a structure, fixed by the damping ratios at two natural frequencies.

Source: Clough and Penzien, Dynamics of Structures, 2nd ed. 1993, §12-5 (thesis Eq. 3.5 and Appendix B, whose a₀ is α and
a₁ is β).
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class RayleighCoefficients:
    """Coefficients of C = αM + βK.

    Attributes:
        mass_coefficient: α [1/s].
        stiffness_coefficient: β [s].
    """

    mass_coefficient: float
    stiffness_coefficient: float

    def ratio(self, angular_frequency: float) -> float:
        """Compute the damping ratio of a mode: ζ = (α/ω + βω)/2 (thesis Eq. B.1).

        Args:
            angular_frequency: Natural frequency ω of the mode [rad/s].

        Returns:
            Damping ratio [-].
        """
        return (self.mass_coefficient / angular_frequency + self.stiffness_coefficient * angular_frequency) / 2

    def matrix(self, *, mass: NDArray[np.float64], stiffness: NDArray[np.float64]) -> NDArray[np.float64]:
        """Assemble C = αM + βK (thesis Eq. 3.5).

        Args:
            mass: Mass matrix M (N, N) [SI].
            stiffness: Stiffness matrix K (N, N) [SI].

        Returns:
            Damping matrix C (N, N) [SI].
        """
        return self.mass_coefficient * mass + self.stiffness_coefficient * stiffness


def rayleigh_damping(
    *, lower_frequency: float, lower_ratio: float, upper_frequency: float, upper_ratio: float
) -> RayleighCoefficients:
    """Solve for the damping that gives two modes the stated ratios (thesis Eq. B.2-B.3; Clough and Penzien 1993, §12-5).

    Args:
        lower_frequency: Lower natural frequency [rad/s].
        lower_ratio: Damping ratio there, not negative [-].
        upper_frequency: Upper natural frequency [rad/s].
        upper_ratio: Damping ratio there, not negative [-].

    Returns:
        Coefficients α [1/s] and β [s].

    Raises:
        ValueError: The frequencies are not positive, finite and ascending, a ratio is negative or not finite, or the ratios
            lie so far apart that α or β would be negative, which feeds energy into some modes.
    """
    if not (0 < lower_frequency < upper_frequency and math.isfinite(upper_frequency)):
        raise ValueError(
            f"lower_frequency {lower_frequency} and upper_frequency {upper_frequency} must be positive, finite and ascending"
        )
    for name, ratio in (("lower_ratio", lower_ratio), ("upper_ratio", upper_ratio)):
        if not (math.isfinite(ratio) and ratio >= 0):
            raise ValueError(f"{name} {ratio} must be finite and not negative")
    span = upper_frequency**2 - lower_frequency**2
    alpha = 2 * lower_frequency * upper_frequency * (upper_frequency * lower_ratio - lower_frequency * upper_ratio) / span
    beta = 2 * (upper_frequency * upper_ratio - lower_frequency * lower_ratio) / span
    # Rounding may leave a hair below zero where the exact coefficient is zero.
    slack = 1e-12 * max(lower_ratio, upper_ratio)
    if alpha < -slack * upper_frequency or beta < -slack / upper_frequency:
        smallest, largest = lower_frequency / upper_frequency, upper_frequency / lower_frequency
        raise ValueError(
            f"ratios {lower_ratio} and {upper_ratio} give a negative coefficient: upper_ratio must lie between "
            f"{smallest:.4g} and {largest:.4g} times lower_ratio"
        )
    return RayleighCoefficients(mass_coefficient=max(alpha, 0.0), stiffness_coefficient=max(beta, 0.0))
