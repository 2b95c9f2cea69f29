"""Film of one bearing of a machine document, in the machine's axes and SI units."""

import math
from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats
from estimator.films.dimensional_film import dimensional_film
from estimator.films.film import Film, FilmCoefficients, FilmOverPosition
from estimator.films.oil import grade_oil
from estimator.films.pad_table import MOST_CONTINUOUS
from estimator.films.profiles import BearingProfile, elliptical, four_lobe, plain, three_lobe, two_axial_grooves
from estimator.films.reynolds import Bools
from estimator.films.tilting_film import TiltingFilm, TiltingProfile
from estimator.machine.films import JournalFilm, Oil, TiltingPads


@dataclass(frozen=True)
class JournalBearing:
    """A journal bearing with its film.

    Attributes:
        name: Id of the bearing.
        film: Its film, of a journal that turns from +x to +y.
        said: What the document says of it.
        viscosity: Dynamic viscosity [Pa s].
        direction: Sense of rotation, +1 or -1 [-].
    """

    name: str
    film: FilmOverPosition
    said: JournalFilm
    viscosity: float
    direction: int

    @property
    def clearance(self) -> float:
        """Return the radial clearance of the pads [m]."""
        return self.said.radial_clearance

    @property
    def radius(self) -> float:
        """Return the radius of the journal [m]."""
        return self.said.diameter / 2

    def covers(self, position: Floats) -> bool:
        """Return whether the film is known at a position.

        Args:
            position: Position (2,) of the journal relative to the bearing's centre [m].

        Returns:
            Whether it is.
        """
        return bool(self.covers_all(position))

    def covers_all(self, position: Floats) -> Bools:
        """Return where the film is known.

        Args:
            position: Positions (..., 2) of the journal relative to the bearing's centre [m].

        Returns:
            Whether it is (...).
        """
        return self.film.covers(self._mirrored(position) / self.clearance)

    def thinnest(self, position: Floats) -> float:
        """Compute the thickness of the film where it is thinnest.

        Args:
            position: Position (2,) of the journal relative to the bearing's centre [m].

        Returns:
            The thickness [m].
        """
        return float(self.film.thinnest(self._mirrored(position) / self.clearance)) * self.clearance

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
        found = dimensional_film(
            self.film,
            self._mirrored(position),
            radius=self.radius,
            length=self.said.length,
            clearance=self.clearance,
            viscosity=self.viscosity,
            speed=speed,
        )
        sign = self._sign
        pairs, triples = np.outer(sign, sign), np.einsum("i,j,k->ijk", sign, sign, sign)
        return FilmCoefficients(
            found.force * sign,
            found.stiffness * pairs,
            found.damping * pairs,
            found.stiffness_slope * triples,
            found.damping_slope * triples,
            None if found.pads is None else found.pads.turned(sign),
        )

    @property
    def _sign(self) -> Floats:
        # A journal that turns the other way sees the mirror image.
        return np.array([float(self.direction), 1.0])

    def _mirrored(self, position: Floats) -> Floats:
        return np.asarray(np.asarray(position) * self._sign)


def journal_bearing(name: str, said: JournalFilm, *, direction: int) -> JournalBearing:
    """Make a bearing's film; the first of a geometry takes seconds, the next are taken from a cache.

    Args:
        name: Id of the bearing.
        said: What the document says of its film.
        direction: Sense of rotation, +1 or -1 [-].

    Returns:
        The bearing.

    Raises:
        InvalidSlenderness: No bearing has this ratio of length to diameter.
    """
    slenderness = said.length / said.diameter
    film: FilmOverPosition
    if said.pads is None:
        film = Film(_profile(said, direction), slenderness)
    else:
        film = TiltingFilm(_tilting(said, said.pads, direction), slenderness)
    return JournalBearing(name, film, said, oil_viscosity(said.oil), direction)


def oil_viscosity(oil: Oil) -> float:
    """Return the dynamic viscosity of an oil (ASTM D341).

    Args:
        oil: What the document says of it.

    Returns:
        Dynamic viscosity [Pa s].

    Raises:
        ValueError: The oil gives neither, which no document's oil does.
    """
    if oil.viscosity is not None:
        return oil.viscosity
    if oil.iso_vg is None or oil.temperature_c is None:
        raise ValueError("an oil needs its viscosity, or its grade and temperature")
    return float(grade_oil(oil.iso_vg).viscosity(oil.temperature_c))


def _tilting(said: JournalFilm, pads: TiltingPads, direction: int) -> TiltingProfile:
    below = -math.pi / 2 + direction * math.radians(said.turned_deg)
    first = below if pads.load == "on_pad" else below + math.pi / pads.number
    return TiltingProfile(pads.number, math.radians(pads.arc_deg), said.preload, pads.pivot, first)


def _profile(said: JournalFilm, direction: int) -> BearingProfile:
    groove, turned = math.radians(said.groove_deg), direction * math.radians(said.turned_deg)
    if said.profile == "plain":
        # Without grooves nothing says where the film begins.
        return plain(continuous=said.length <= MOST_CONTINUOUS * said.diameter)
    if said.profile == "two_axial_grooves":
        return two_axial_grooves(groove=groove, split=turned)
    if said.profile == "elliptical":
        return elliptical(preload=said.preload, groove=groove, split=turned)
    if said.profile == "three_lobe":
        return three_lobe(preload=said.preload, groove=groove, first=turned - math.pi / 2)
    return four_lobe(preload=said.preload, groove=groove, first=turned - math.pi / 4)
