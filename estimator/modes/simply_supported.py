"""A uniform shaft on simple supports: natural frequencies in closed form, at rest and spinning.

The deflection of mode n is sin(nπz/L), whatever the theory: Euler-Bernoulli, Rayleigh (with rotary inertia and gyroscopic
effect) or Timoshenko (with shear besides), as in Zu and Han, J. Applied Mechanics 59 (1992) S197. The disc at mid span is
the thesis's Appendix C.
"""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from estimator.rotor.shaft_element import shear_coefficient

Theory = Literal["Euler-Bernoulli", "Rayleigh", "Timoshenko"]
Whirl = Literal["forward", "backward"]


@dataclass(frozen=True)
class SimplySupportedShaft:
    """A uniform shaft on simple supports.

    Attributes:
        span: Distance of the supports [m].
        outer_diameter: Outer diameter [m].
        young_modulus: Young's modulus [N/m²].
        density: Density [kg/m³].
        inner_diameter: Inner diameter [m].
        poisson_ratio: Poisson's ratio [-].
    """

    span: float
    outer_diameter: float
    young_modulus: float
    density: float
    inner_diameter: float = 0.0
    poisson_ratio: float = 0.3

    def __post_init__(self) -> None:
        for name in ("span", "outer_diameter", "young_modulus", "density"):
            if not getattr(self, name) > 0.0:
                raise ValueError(f"{name} {getattr(self, name)} must be positive")
        if not 0.0 <= self.inner_diameter < self.outer_diameter:
            raise ValueError(f"inner_diameter {self.inner_diameter} must be at least 0 and below {self.outer_diameter}")

    @property
    def second_moment(self) -> float:
        """Return the second moment I of the cross-section [m⁴]."""
        return math.pi / 64 * (self.outer_diameter**4 - self.inner_diameter**4)

    @property
    def mass(self) -> float:
        """Return the mass between the supports [kg]."""
        return self.density * math.pi / 4 * (self.outer_diameter**2 - self.inner_diameter**2) * self.span

    @property
    def midspan_stiffness(self) -> float:
        """Return the force per deflection at mid span, 48EI/L³ [N/m] (thesis Eq. C.2)."""
        return 48 * self.young_modulus * self.second_moment / self.span**3


def natural_frequency(
    shaft: SimplySupportedShaft, *, mode: int, theory: Theory = "Timoshenko", spin: float = 0.0, whirl: Whirl = "forward"
) -> float:
    """Compute a natural frequency of bending in closed form (Zu and Han, J. Applied Mechanics 59 (1992) S197).

    Args:
        shaft: The shaft.
        mode: Number of half waves, from 1.
        theory: Theory of the beam.
        spin: Speed of rotation, not negative [rad/s].
        whirl: Whirl in the sense of rotation or against it; no difference at rest and none in the Euler-Bernoulli theory.

    Returns:
        Natural frequency [rad/s].

    Raises:
        ValueError: The mode is below 1, or the spin is negative.
    """
    if mode < 1:
        raise ValueError(f"mode {mode}: the first one is 1")
    if spin < 0.0:
        raise ValueError(f"spin {spin} must not be negative: the sense of whirl is counted from it")
    wave = mode * math.pi / shaft.span
    area_density = shaft.mass / shaft.span
    bending = shaft.young_modulus * shaft.second_moment * wave**4 / area_density
    if theory == "Euler-Bernoulli":
        return math.sqrt(bending)
    rotary = shaft.density * shaft.second_moment * wave**2 / area_density
    shear = _shear_flexibility(shaft) * wave**2 if theory == "Timoshenko" else 0.0
    # bending - ω² - rotary (ω² - 2Ωω) - shear ω² + (rotary shear / bending) ω² (ω² - 2Ωω) = 0; ω < 0 whirls backward.
    both = rotary * shear / bending
    roots = np.roots([both, -2 * spin * both, -(1 + rotary + shear), 2 * spin * rotary, bending])
    sense = 1.0 if whirl == "forward" else -1.0
    return float(min(sense * root.real for root in roots if sense * root.real > 0.0))


def disc_at_midspan_frequency(shaft: SimplySupportedShaft, *, disc_mass: float, massless: bool = True) -> float:
    """Compute the first natural frequency with a disc at mid span.

    Massless: √(48EI/(L³m)), thesis Eq. C.1-C.2. Otherwise 17/35 of the shaft's mass, its share in the deflection under a force
    at mid span, moves with the disc: Rayleigh's quotient, an upper bound.

    Args:
        shaft: The shaft.
        disc_mass: Mass of the disc [kg].
        massless: Whether the shaft's mass is left out.

    Returns:
        Natural frequency [rad/s].

    Raises:
        ValueError: The mass of the disc is not positive.
    """
    if not disc_mass > 0.0:
        raise ValueError(f"disc_mass {disc_mass} must be positive")
    return math.sqrt(shaft.midspan_stiffness / (disc_mass + (0.0 if massless else 17 / 35 * shaft.mass)))


def span_for(*, frequency: float, diameter: float, disc_mass: float, young_modulus: float) -> float:
    """Compute the span of the solid massless shaft whose disc at mid span has a natural frequency (thesis Eq. C.1-C.2).

    Args:
        frequency: Natural frequency [rad/s].
        diameter: Diameter [m].
        disc_mass: Mass of the disc [kg].
        young_modulus: Young's modulus [N/m²].

    Returns:
        Span [m].
    """
    return float((48 * young_modulus * math.pi / 64 * diameter**4 / (disc_mass * frequency**2)) ** (1 / 3))


def _shear_flexibility(shaft: SimplySupportedShaft) -> float:
    """Compute EI/(κGA) [m²]."""
    kappa = shear_coefficient(poisson_ratio=shaft.poisson_ratio, diameter_ratio=shaft.inner_diameter / shaft.outer_diameter)
    area = shaft.mass / (shaft.density * shaft.span)
    return 2 * (1 + shaft.poisson_ratio) * shaft.second_moment / (kappa * area)
