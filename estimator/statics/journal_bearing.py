"""Film of one bearing of a machine document, in the machine's axes and SI units."""

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from estimator.arrays import Floats
from estimator.films.dimensional_film import FilmScale, film_in_si, film_scale
from estimator.films.film import Film, FilmCoefficients, FilmOverPosition
from estimator.films.heat_balance import film_temperature
from estimator.films.oil import grade_oil
from estimator.films.pad_table import MOST_CONTINUOUS, TABLES
from estimator.films.profiles import BearingProfile, elliptical, four_lobe, plain, three_lobe, two_axial_grooves
from estimator.films.tilting_film import TiltingFilm, TiltingProfile
from estimator.films.viscosity_over_speed import ViscosityOverSpeed
from estimator.machine.films import JournalFilm, TiltingPads

HEATED_SPEEDS = 12
"""Number of speeds at which a heat balance gives the temperature of a film."""


@dataclass(frozen=True)
class JournalBearing:
    """A journal bearing with its film.

    Attributes:
        name: Id of the bearing.
        film: Its film, of a journal that turns from +x to +y.
        described: What the document says of it.
        oil: Viscosity of its oil over speed.
        direction: Sense of rotation, +1 or -1 [-].
    """

    name: str
    film: FilmOverPosition
    described: JournalFilm
    oil: ViscosityOverSpeed
    direction: int

    @property
    def clearance(self) -> float:
        """Return the radial clearance of the pads [m]."""
        return self.described.radial_clearance

    @property
    def radius(self) -> float:
        """Return the radius of the journal [m]."""
        return self.described.diameter / 2

    @property
    def raised(self) -> tuple[float, float]:
        """Return where the document has its centre, over the aligned place, along x and y [m]."""
        return self.described.elevation_x, self.described.elevation_y

    @property
    def turns_sharply(self) -> bool:
        """Return whether the film may turn sharply where the journal passes a lobe's centre of curvature."""
        return self.described.pads is None and self.described.preload > 0.0

    def covers(self, position: Floats) -> bool:
        """Return whether the film is known at a position.

        Args:
            position: Position (2,) of the journal relative to the bearing's centre [m].

        Returns:
            Whether it is.
        """
        return bool(self.film.covers(self.mirrored(position) / self.clearance))

    def thinnest(self, position: Floats) -> float:
        """Compute the thickness of the film where it is thinnest.

        Args:
            position: Position (2,) of the journal relative to the bearing's centre [m].

        Returns:
            The thickness [m].
        """
        return float(self.film.thinnest(self.mirrored(position) / self.clearance)) * self.clearance

    def at(self, position: Floats, *, speed: Floats | float) -> FilmCoefficients:
        """Compute force on the journal, stiffness and damping, with their derivatives by the position.

        Args:
            position: Positions (..., 2) of the journal relative to the bearing's centre [m].
            speed: Spin speed, without sign (...) [rad/s].

        Returns:
            The film there.

        Raises:
            OutsideFilm: The film is thinner there than it is known.
        """
        scale = self.scale(speed)
        return turned(film_in_si(self.film.at(self.mirrored(position) / scale.clearance[..., None]), scale), self.sign)

    def scale(self, speed: Floats | float) -> FilmScale:
        """Compute the units of the film.

        Args:
            speed: Spin speeds, without sign (...) [rad/s].

        Returns:
            The units (...).
        """
        return film_scale(
            radius=self.radius,
            length=self.described.length,
            clearance=self.clearance,
            viscosity=self.oil.at(speed),
            speed=speed,
        )

    @property
    def sign(self) -> Floats:
        """Return the signs (2,) of the machine's axes in the film's: one that turns the other way is its mirror image [-]."""
        return np.array([float(self.direction), 1.0])

    def mirrored(self, position: Floats) -> Floats:
        """Return positions in the axes of the film.

        Args:
            position: Positions (..., 2) in the machine's axes; last axis: component x, y [m].

        Returns:
            The same (..., 2) as the film sees them [m].
        """
        return np.asarray(np.asarray(position) * self.sign)


def turned(film: FilmCoefficients, sign: Floats) -> FilmCoefficients:
    """Return a film in axes of which some point the other way.

    Args:
        film: The film.
        sign: Signs (2,) of the axes; shape (component,) with components x, y [-].

    Returns:
        The film.
    """
    pairs, triples = np.outer(sign, sign), np.einsum("i,j,k->ijk", sign, sign, sign)
    return FilmCoefficients(
        film.force * sign,
        film.stiffness * pairs,
        film.damping * pairs,
        film.stiffness_slope * triples,
        film.damping_slope * triples,
        None if film.pads is None else film.pads.turned(sign),
    )


def journal_bearing(
    name: str, described: JournalFilm, *, direction: int, load: Floats, speeds: tuple[float, float, float]
) -> JournalBearing:
    """Make a bearing's film; the first of a geometry takes seconds, the next are taken from a cache.

    Args:
        name: Id of the bearing.
        described: What the document says of its film.
        direction: Sense of rotation, +1 or -1 [-].
        load: Load (2,) on the journal at rest, by which an oil that comes at some temperature is warmed; shape (axis,) [N].
        speeds: Lowest and highest speed of the machine, and that at which viscosity is told [rad/s].

    Returns:
        The bearing.

    Raises:
        InvalidSlenderness: No bearing has this ratio of length to diameter.
    """
    slenderness = described.length / described.diameter
    film: FilmOverPosition
    if described.pads is None:
        film = _film(_profile(described, direction), slenderness)
    else:
        film = _tilting_film(_tilting(described, described.pads, direction), slenderness)
    return JournalBearing(name, film, described, _oil(described, film, load * (float(direction), 1.0), speeds), direction)


@lru_cache(maxsize=TABLES)
def _film(profile: BearingProfile, slenderness: float) -> Film:
    """Return the film of a geometry: bearings that are alike have the same."""
    return Film(profile, slenderness)


@lru_cache(maxsize=TABLES)
def _tilting_film(profile: TiltingProfile, slenderness: float) -> TiltingFilm:
    """Return the film of tilting pads, the same of bearings that are alike."""
    return TiltingFilm(profile, slenderness)


def _oil(
    described: JournalFilm, film: FilmOverPosition, load: Floats, speeds: tuple[float, float, float]
) -> ViscosityOverSpeed:
    """Return the viscosity over speed (ASTM D341); the load is in the film's axes."""
    lowest, highest, told = speeds
    oil = described.oil
    if oil.viscosity is not None:
        return ViscosityOverSpeed(oil.viscosity, told)
    assert oil.iso_vg is not None  # as the document's checks say
    grade = grade_oil(oil.iso_vg)
    if oil.temperature_c is not None:
        return ViscosityOverSpeed(float(grade.viscosity(oil.temperature_c)), told)
    assert oil.inlet_c is not None
    speed = np.geomspace(lowest, highest, HEATED_SPEEDS)
    warm = film_temperature(
        film,
        oil=grade,
        inlet=oil.inlet_c,
        carried=oil.carried,
        load=load,
        radius=described.diameter / 2,
        length=described.length,
        clearance=described.radial_clearance,
        speed=speed,
    )
    course = ViscosityOverSpeed(1.0, told, course=(speed, grade.viscosity(warm)))
    return replace(course, value=float(np.exp(np.interp(np.log(told), np.log(speed), np.log(grade.viscosity(warm))))))


def _tilting(described: JournalFilm, pads: TiltingPads, direction: int) -> TiltingProfile:
    below = -math.pi / 2 + direction * math.radians(described.turned_deg)
    first = below if pads.load == "on_pad" else below + math.pi / pads.number
    return TiltingProfile(pads.number, math.radians(pads.arc_deg), described.preload, pads.pivot, first)


def _profile(described: JournalFilm, direction: int) -> BearingProfile:
    groove, turned = math.radians(described.groove_deg), direction * math.radians(described.turned_deg)
    if described.profile == "plain":
        # Without grooves nothing says where the film begins.
        return plain(continuous=described.length <= MOST_CONTINUOUS * described.diameter)
    if described.profile == "two_axial_grooves":
        return two_axial_grooves(groove=groove, split=turned)
    if described.profile == "elliptical":
        return elliptical(preload=described.preload, groove=groove, split=turned)
    if described.profile == "three_lobe":
        return three_lobe(preload=described.preload, groove=groove, first=turned - math.pi / 2)
    return four_lobe(preload=described.preload, groove=groove, first=turned - math.pi / 4)
