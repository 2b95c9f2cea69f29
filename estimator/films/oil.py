"""Dynamic viscosity of oils over their temperature."""

from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats
from estimator.errors import Invalid

KELVIN = 273.15
"""Zero of the Celsius scale [K]."""
COLDEST, HOTTEST = -20.0, 180.0
"""Range in which Walther's law is used [°C]."""
STANDARD_DENSITY = 870.0
"""Density of a mineral turbine oil at 15 °C [kg/m³]."""
EXPANSION = 6.5e-4
"""Thermal expansion of mineral oil, referred to its density at 15 °C [1/K]."""
_CENTISTOKES = 1e-6
_VISCOSITY_AT_100 = {
    10: 2.6, 15: 3.4, 22: 4.3, 32: 5.4, 46: 6.8, 68: 8.7, 100: 11.2, 150: 14.8, 220: 19.0, 320: 24.2, 460: 30.8, 680: 39.2,
}  # fmt: skip


class InvalidOil(Invalid):
    """Raised when no oil has the data given."""


@dataclass(frozen=True)
class WaltherOil:
    """Oil that follows Walther's law, log log(ν + 0.7) = A - B log T, through two points (ASTM D341).

    Attributes:
        viscosity_at_40: Kinematic viscosity at 40 °C, which is the ISO VG grade (ISO 3448) [mm²/s].
        viscosity_at_100: Kinematic viscosity at 100 °C [mm²/s].
        density: Density at 15 °C [kg/m³].
    """

    viscosity_at_40: float
    viscosity_at_100: float
    density: float = STANDARD_DENSITY

    def __post_init__(self) -> None:
        if not 1.0 < self.viscosity_at_100 < self.viscosity_at_40 < 1e4:
            raise InvalidOil(
                f"viscosities of {self.viscosity_at_40:g} mm²/s at 40 °C and {self.viscosity_at_100:g} mm²/s at 100 °C: "
                "that at 100 °C must be the smaller, and both between 1 and 10 000 mm²/s"
            )
        if not 500.0 < self.density < 1500.0:
            raise InvalidOil(f"a density of {self.density:g} kg/m³: oils have 800 to 1000 kg/m³")

    def viscosity(self, temperature: Floats | float) -> Floats:
        """Compute the dynamic viscosity.

        Args:
            temperature: Temperatures (...) [°C].

        Returns:
            Dynamic viscosities (...) [Pa s].
        """
        return self._kinematic(_checked(temperature))[0] * self._density(np.asarray(temperature))

    def slope(self, temperature: Floats | float) -> Floats:
        """Compute the derivative of the dynamic viscosity by the temperature.

        Args:
            temperature: Temperatures (...) [°C].

        Returns:
            Derivatives (...) [Pa s/K].
        """
        kinematic, slope = self._kinematic(_checked(temperature))
        return slope * self._density(np.asarray(temperature)) - kinematic * EXPANSION * self.density

    def _density(self, temperature: Floats) -> Floats:
        return self.density * (1.0 - EXPANSION * (temperature - 15.0))

    def _kinematic(self, temperature: Floats) -> tuple[Floats, Floats]:
        low, high = np.log10(40.0 + KELVIN), np.log10(100.0 + KELVIN)
        at_low, at_high = np.log10(np.log10(np.array([self.viscosity_at_40, self.viscosity_at_100]) + 0.7))
        steepness = (at_high - at_low) / (high - low)
        logarithm = 10.0 ** (at_low + steepness * (np.log10(temperature + KELVIN) - low))
        value = 10.0**logarithm
        slope = value * np.log(10.0) * logarithm * steepness / (temperature + KELVIN)
        return (value - 0.7) * _CENTISTOKES, slope * _CENTISTOKES


def grade_oil(grade: int, *, viscosity_at_100: float | None = None, density: float = STANDARD_DENSITY) -> WaltherOil:
    """Return the oil of an ISO VG grade.

    Args:
        grade: ISO VG grade (ISO 3448), such as 46.
        viscosity_at_100: Kinematic viscosity at 100 °C [mm²/s]; None for that of a mineral oil of viscosity index 100,
            as turbine oils have; between oils of index 95 and 105 it varies by 2 %.
        density: Density at 15 °C [kg/m³].

    Returns:
        The oil.

    Raises:
        InvalidOil: There is no such grade, and the viscosity at 100 °C is not given.
    """
    if viscosity_at_100 is None:
        if grade not in _VISCOSITY_AT_100:
            known = ", ".join(str(one) for one in _VISCOSITY_AT_100)
            raise InvalidOil(f"no ISO VG grade {grade}: there are {known}; others need their viscosity at 100 °C")
        viscosity_at_100 = _VISCOSITY_AT_100[grade]
    return WaltherOil(float(grade), viscosity_at_100, density)


def _checked(temperature: Floats | float) -> Floats:
    given = np.asarray(temperature, dtype=float)
    if not np.all((given >= COLDEST) & (given <= HOTTEST)):
        raise InvalidOil(f"an oil temperature outside {COLDEST:g} to {HOTTEST:g} °C: is it in another unit?")
    return given
