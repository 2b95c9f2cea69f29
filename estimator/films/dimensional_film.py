"""Films in SI units."""

from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats
from estimator.errors import Invalid
from estimator.films.film import FilmCoefficients, FilmOverPosition


class InvalidFilmData(Invalid):
    """Raised when no film has the dimensions, the viscosity or the speed given."""


@dataclass(frozen=True)
class FilmScale:
    """Units of a film's forces and coefficients at operating conditions (...).

    Attributes:
        clearance: Unit of length, the pads' radial clearance c (...) [m].
        force: Unit of force, μ ω R L (R/c)² (...) [N].
        speed: Spin speed ω (...) [rad/s].
    """

    clearance: Floats
    force: Floats
    speed: Floats


def film_scale(
    *, radius: float, length: float, clearance: Floats | float, viscosity: Floats | float, speed: Floats | float
) -> FilmScale:
    """Compute the units of a film.

    Args:
        radius: Radius of the journal R [m].
        length: Length of the bearing L [m].
        clearance: Radial clearance of the pads c (...) [m].
        viscosity: Dynamic viscosity μ (...) [Pa s].
        speed: Spin speed ω, without sign (...) [rad/s].

    Returns:
        The units.

    Raises:
        InvalidFilmData: A number is not positive, or the clearance is above a tenth of the radius.
    """
    given = {"radius": radius, "length": length, "clearance": clearance, "viscosity": viscosity, "speed": speed}
    for name, value in given.items():
        least, largest = (value, value) if isinstance(value, float) else (np.min(value), np.max(value))
        if not 0.0 < least <= largest < np.inf:
            raise InvalidFilmData(f"{name} is {np.min(value):g}: it must be positive")
    if np.any(np.asarray(clearance) > 0.1 * radius):
        raise InvalidFilmData(
            f"a radial clearance of {np.max(clearance):g} m in a bearing of radius {radius:g} m: usual is a thousandth of the "
            "radius, and a tenth the most"
        )
    w = np.asarray(speed, dtype=float)
    force = viscosity * w * radius * length * (radius / clearance) ** 2
    even = np.ones_like(force)
    return FilmScale(even * clearance, force, even * w)


def dimensional_film(
    film: FilmOverPosition,
    position: Floats,
    *,
    radius: float,
    length: float,
    clearance: Floats | float,
    viscosity: Floats | float,
    speed: Floats | float,
) -> FilmCoefficients:
    """Compute forces, coefficients and their derivatives in SI units.

    Args:
        film: The film, whose slenderness is length over twice the radius.
        position: Positions (..., 2) of the journal relative to the bearing's centre [m].
        radius: Radius of the journal [m].
        length: Length of the bearing [m].
        clearance: Radial clearance of the pads (...) [m].
        viscosity: Dynamic viscosity (...) [Pa s].
        speed: Spin speed, without sign (...) [rad/s].

    Returns:
        Forces (..., 2) [N], stiffness (..., 2, 2) [N/m], damping (..., 2, 2) [N s/m], and their derivatives.
    """
    scale = film_scale(radius=radius, length=length, clearance=clearance, viscosity=viscosity, speed=speed)
    return film_in_si(film.at(np.asarray(position) / scale.clearance[..., None]), scale)


def film_in_si(film: FilmCoefficients, scale: FilmScale) -> FilmCoefficients:
    """Convert forces, coefficients and their derivatives to SI units.

    Args:
        film: The film at positions (...), in its own units.
        scale: These units (...).

    Returns:
        Forces (..., 2) [N], stiffness (..., 2, 2) [N/m], damping (..., 2, 2) [N s/m], and their derivatives.
    """
    force, c = scale.force, scale.clearance
    stiffness, damping = force / c, force / (c * scale.speed)
    return FilmCoefficients(
        film.force * force[..., None],
        film.stiffness * stiffness[..., None, None],
        film.damping * damping[..., None, None],
        film.stiffness_slope * (force / c**2)[..., None, None, None],
        film.damping_slope * (force / (c**2 * scale.speed))[..., None, None, None],
        None if film.pads is None else film.pads.rescaled(stiffness=stiffness, damping=damping),
    )
