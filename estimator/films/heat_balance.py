"""Temperature of an oil film: the heat of its friction is carried off by the oil that leaves at the sides.

Friction by Petroff's law over √(1 - ε²), 2π μ ω² R³ L/c; side flow of a short bearing, ε U c L, and what is fed besides.
M. M. Khonsari, E. R. Booser, Applied Tribology, 2nd ed., Wiley 2008, ch. 8. It is an estimate: the document
states how far a film's viscosity, and its fall with speed, may be from it.
"""

import numpy as np

from estimator.arrays import Floats
from estimator.films.dimensional_film import film_scale
from estimator.films.equilibrium import EquilibriumSearch, FilmOverloaded
from estimator.films.film import FilmOverPosition
from estimator.films.oil import HOTTEST, WaltherOil

HEAT_CAPACITY = 2000.0
"""Specific heat of mineral oil [J/(kg K)]."""
FED = 0.1
"""Oil that is fed under pressure and leaves without passing the loaded part, in units of U c L [-]."""
LARGEST_ECCENTRICITY = 0.98
"""Largest eccentricity in the balance [-]."""
BISECTIONS = 24
"""Number of times that the range of temperatures is halved: to 1e-5 K."""


def film_temperature(
    film: FilmOverPosition,
    *,
    oil: WaltherOil,
    inlet: float,
    carried: float,
    load: Floats,
    radius: float,
    length: float,
    clearance: float,
    speed: Floats,
) -> Floats:
    """Compute the temperatures at which the heat of friction and that carried off are in balance (Khonsari and Booser 2008).

    Args:
        film: The film.
        oil: The oil.
        inlet: Temperature at which it comes [°C].
        carried: Part of the heat that the oil carries off [-]; the rest goes through journal and housing.
        load: Load (2,) on the journal, in the film's axes x, y; shape (axis,) [N].
        radius: Radius of the journal [m].
        length: Length of the bearing [m].
        clearance: Radial clearance of the pads [m].
        speed: Spin speeds (S,), without sign [rad/s].

    Returns:
        Temperatures (S,) [°C].
    """
    search = EquilibriumSearch(film)
    cold, hot = np.full(speed.size, inlet), np.full(speed.size, HOTTEST - 1.0)
    for _ in range(BISECTIONS):
        middle = (cold + hot) / 2
        viscosity = oil.viscosity(middle)
        scale = film_scale(radius=radius, length=length, clearance=clearance, viscosity=viscosity, speed=speed)
        eccentricity = _eccentricities(search, load / scale.force[:, None])
        friction = 2 * np.pi * viscosity * speed**2 * radius**3 * length / (clearance * np.sqrt(1.0 - eccentricity**2))
        flow = (eccentricity + FED) * speed * radius * clearance * length
        rise = carried * friction / (oil.density * HEAT_CAPACITY * flow)
        cold, hot = np.where(inlet + rise > middle, middle, cold), np.where(inlet + rise > middle, hot, middle)
    return np.asarray((cold + hot) / 2)


def _eccentricities(search: EquilibriumSearch, load: Floats) -> Floats:
    """Return 1 less the thinnest film over the clearance (S,) [-] under loads (S, 2); the largest where one is not carried."""
    found = np.full(len(load), LARGEST_ECCENTRICITY)
    try:
        carried, position = np.ones(len(load), dtype=bool), search.position(load)
    except FilmOverloaded as error:
        carried = error.carried
        position = search.position(load[carried])
    found[carried] = np.clip(1.0 - search.film.thinnest(position), 0.0, LARGEST_ECCENTRICITY)
    return found
