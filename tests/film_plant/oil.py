"""Oil whose viscosity falls with its temperature, and the temperature that a bearing gives it.

Viscosity over temperature: Walther's law, ASTM D341, through the grade's viscosity at 40 °C and the usual one at 100 °C of
mineral oils with a viscosity index near 100. Heat balance as in Khonsari and Booser, Applied Tribology (2nd ed. 2008): power
by Petroff's law over √(1 - ε²), carried off by the oil that leaves at the sides, ε U c L of a short bearing, and by more
that is fed.
"""

from dataclasses import dataclass

import numpy as np
import scipy.optimize

from tests.film_plant.train import Bearing

AT_100_C = {32: 5.4, 46: 6.8, 68: 8.7}
"""Kinematic viscosity at 100 °C by ISO VG grade [mm²/s]."""
DENSITY = 860.0
"""Density of oil [kg/m³]."""
HEAT_CAPACITY = 2000.0
"""Specific heat of oil [J/(kg K)]."""
KELVIN = 273.15
"""Zero of the Celsius scale [K]."""
HOTTEST_RISE = 150.0
"""Largest rise of temperature; where the balance asks for more, it is this [K]."""


def walther(grade: int, temperature: float) -> float:
    """Compute the dynamic viscosity [Pa s] of an ISO VG grade at a temperature [°C]."""
    low, high = np.log10(40.0 + KELVIN), np.log10(100.0 + KELVIN)
    at_low, at_high = (np.log10(np.log10(one + 0.7)) for one in (float(grade), AT_100_C[grade]))
    place = (np.log10(temperature + KELVIN) - low) / (high - low)
    return float((10.0**10.0 ** (at_low + place * (at_high - at_low)) - 0.7) * 1e-6 * DENSITY)


@dataclass(frozen=True)
class HeatedOil:
    """Oil that a bearing warms.

    Attributes:
        grade: ISO VG grade [mm²/s].
        inlet: Temperature at which it comes [°C].
        factor: Viscosity over that of the grade [-].
        carried: Part of the lost power that the oil carries off [-].
        feed: Flow that is fed besides the side flow, in units of U c L [-].
    """

    grade: int
    inlet: float
    factor: float = 1.0
    carried: float = 0.8
    feed: float = 0.1

    def viscosity(self, bearing: Bearing, *, speed: float, eccentricity: float) -> float:
        """Viscosity [Pa s] at which lost power and carried heat are in balance."""
        return self.factor * walther(self.grade, self.temperature(bearing, speed=speed, eccentricity=eccentricity))

    def temperature(self, bearing: Bearing, *, speed: float, eccentricity: float) -> float:
        """Effective temperature of the film [°C] at a speed [rad/s] and an eccentricity [-]."""
        flow = min(eccentricity, 0.99) + self.feed
        shape = np.sqrt(1.0 - min(eccentricity, 0.99) ** 2) * flow
        part = 2 * np.pi * speed * (bearing.diameter / 2 / bearing.clearance) ** 2 / (DENSITY * HEAT_CAPACITY * shape)

        def excess(rise: float) -> float:
            return float(rise - self.carried * part * self.factor * walther(self.grade, self.inlet + rise))

        if excess(HOTTEST_RISE) < 0.0:
            return self.inlet + HOTTEST_RISE
        return self.inlet + float(scipy.optimize.brentq(excess, 0.0, HOTTEST_RISE, xtol=1e-9))
