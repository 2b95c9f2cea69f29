"""Film of a whole bearing: the sum over its pads, in units of the clearance, with derivatives of what is interpolated.

Stiffness and damping as J. W. Lund, J. Tribol. 109 (1987) 37 defines them, at any position and not only where a weight rests.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from estimator.arrays import Bools, Floats
from estimator.errors import Invalid
from estimator.films.pad import FULL_ARC, Pad
from estimator.films.pad_table import MOST_CONTINUOUS, THINNEST_KNOWN, PadTable, PolarFilm, pad_table
from estimator.films.profiles import BearingProfile
from estimator.films.tilted_pads import PositionIndex, TiltedPads


class TableMaker(Protocol):
    """Function that returns the table of a pad."""

    def __call__(self, *, arc: float, slenderness: float, continuous: bool) -> PadTable:
        """Return the table of an arc [rad] and a ratio of length to diameter [-]; `continuous` as of `Pad`."""


_TURN = np.array([[0.0, -1.0], [1.0, 0.0]])
_TO_X = np.array([1.0, 0.0])
_AT_CENTRE = 1e-14
"""Eccentricity below which a film has no direction [c]."""


class OutsideFilm(Invalid):
    """Raised when a film is asked for where it is thinner than it is known, or where no journal can be."""


class InvalidSlenderness(Invalid):
    """Raised when no bearing has the ratio of length to diameter."""


@dataclass(frozen=True)
class FilmCoefficients:
    """Film at positions (...) of the journal: near each, force on the journal = force - K x - C ẋ.

    Where pads tilt this holds for motions at the spin speed; slow ones meet `static_stiffness` instead of K.

    `Film` gives it in units of the clearance, `dimensional_film` in SI. The stiffness of a film that ruptures depends on the
    direction in which the journal leaves the centre of a plain bearing, or the centre of curvature of a pad that is shorter
    than 360°. At these points the values are those of a journal that leaves towards x, with no derivatives by y.

    Attributes:
        force: Forces (..., 2) [μ ω R L (R/c)², or N].
        stiffness: Stiffness K (..., 2, 2); -∂force/∂position unless pads tilt [μ ω R L (R/c)²/c, or N/m].
        damping: Damping C (..., 2, 2) [μ R L (R/c)²/c, or N s/m].
        stiffness_slope: Derivatives (..., 2, 2, 2) of K by the position, whose component is the last axis
            [μ ω R L (R/c)²/c², or N/m²].
        damping_slope: Derivatives (..., 2, 2, 2) of C by the position, whose component is the last axis
            [μ R L (R/c)²/c², or N s/m²].
        pads: Pads that tilt, as degrees of freedom of their own; None for a film whose pads stand still.
    """

    force: Floats
    stiffness: Floats
    damping: Floats
    stiffness_slope: Floats
    damping_slope: Floats
    pads: TiltedPads | None = None

    @property
    def static_stiffness(self) -> Floats:
        """Return -∂force/∂position (..., 2, 2) [μ ω R L (R/c)²/c, or N/m]."""
        return self.stiffness if self.pads is None else self.pads.static_stiffness

    def one_of(self, place: PositionIndex) -> "FilmCoefficients":
        """Return the film at one of several positions.

        Args:
            place: Number of the position along the first axis, or the index of some along several.

        Returns:
            The film there.
        """
        return FilmCoefficients(
            self.force[place],
            self.stiffness[place],
            self.damping[place],
            self.stiffness_slope[place],
            self.damping_slope[place],
            None if self.pads is None else self.pads.at(place),
        )

    def moved(self, step: Floats) -> "FilmCoefficients":
        """Return the film a small step away, to first order in it: its slopes and the pads that tilt stay as they are.

        Args:
            step: Steps (..., 2) of the journal [c, or m].

        Returns:
            The film there.
        """
        along = step[..., None, :, None]
        return replace(
            self,
            force=self.force - (self.static_stiffness @ step[..., None])[..., 0],
            stiffness=self.stiffness + (self.stiffness_slope @ along)[..., 0],
            damping=self.damping + (self.damping_slope @ along)[..., 0],
        )


class FilmOverPosition(Protocol):
    """Film of a bearing over the journal's position, in units of the clearance: of pads that stand still, or tilt."""

    def covers(self, position: Floats) -> Bools:
        """Return where the film is known.

        Args:
            position: Positions (..., 2) [c].

        Returns:
            Whether it is (...).
        """

    def thinnest(self, position: Floats) -> Floats:
        """Compute the thickness of the film where it is thinnest.

        Args:
            position: Positions (..., 2) [c].

        Returns:
            Thicknesses (...), negative where the journal would be in the wall [c].
        """

    def at(self, position: Floats) -> FilmCoefficients:
        """Compute forces, coefficients and their derivatives.

        Args:
            position: Positions (..., 2) of the journal relative to the bearing's centre [c].

        Returns:
            The film at those positions.

        Raises:
            OutsideFilm: The film is not known at one of the positions.
        """


class Film:
    """Film of a bearing over the journal's position.

    Positions are relative to the bearing's centre, in clearances c of the pads (radius of curvature less the journal's
    radius); forces in μ ω R L (R/c)², with viscosity μ, spin speed ω, the journal's radius R and the bearing's length L.
    """

    def __init__(self, profile: BearingProfile, slenderness: float, *, table: TableMaker = pad_table) -> None:
        """Make the tables of its pads, or take those made before; one takes seconds.

        Args:
            profile: Profile of the bearing.
            slenderness: Length over diameter [-].
            table: Function that returns the table of a pad.

        Raises:
            InvalidSlenderness: No bearing has this slenderness.
        """
        slenderness = slenderness_within(slenderness)
        if slenderness > MOST_CONTINUOUS and any(pad.continuous for pad in profile.pads):
            raise InvalidSlenderness(
                f"length over diameter is {slenderness:g}: films that form again by themselves are known up to "
                f"{MOST_CONTINUOUS:g}"
            )
        alike: dict[tuple[float, bool], list[Pad]] = {}
        for pad in profile.pads:
            alike.setdefault((pad.arc, pad.continuous), []).append(pad)
        self._tables = tuple(
            (_AlikePads(pads), table(arc=arc, slenderness=slenderness, continuous=continuous))
            for (arc, continuous), pads in alike.items()
        )

    def covers(self, position: Floats) -> Bools:
        """Return where the film is known: nowhere thinner than three hundredths of the clearance.

        Args:
            position: Positions (..., 2) [c].

        Returns:
            Whether it is (...).
        """
        covered = np.ones(np.shape(position)[:-1], dtype=bool)
        for pads, table in self._tables:
            eccentricity, direction, _ = pads.polar(position)
            covered &= table.covers(eccentricity, direction).all(axis=-1)
        return covered

    def thinnest(self, position: Floats) -> Floats:
        """Compute the thickness of the film where it is thinnest.

        Args:
            position: Positions (..., 2) [c].

        Returns:
            Thicknesses (...), negative where the journal would be in the wall [c].
        """
        found = np.full(np.shape(position)[:-1], np.inf)
        for pads, table in self._tables:
            eccentricity, direction, _ = pads.polar(position)
            found = np.minimum(found, table.thinnest(eccentricity, direction).min(axis=-1))
        return found

    def at(self, position: Floats) -> FilmCoefficients:
        """Compute forces, coefficients and their derivatives.

        Args:
            position: Positions (..., 2) of the journal relative to the bearing's centre [c].

        Returns:
            The film at those positions.

        Raises:
            OutsideFilm: The film is not known at one of the positions.
        """
        position = np.asarray(position, dtype=float)
        polar = [pads.polar(position) for pads, _ in self._tables]
        for (_, table), (eccentricity, direction, _) in zip(self._tables, polar, strict=True):
            if not table.covers(eccentricity, direction).all():
                require_covered(self, position)
        first, *others = [_film_of_pads(table, *seen) for (_, table), seen in zip(self._tables, polar, strict=True)]
        return FilmCoefficients(*(sum(parts[1:], parts[0]) for parts in zip(first, *others, strict=True)))


def require_covered(film: FilmOverPosition, position: Floats) -> None:
    """Check that a film is known at positions.

    Args:
        film: The film.
        position: Positions (..., 2) [c].

    Raises:
        OutsideFilm: The film is not known at one of the positions.
    """
    covered = film.covers(position)
    if not covered.all():
        x, y = position[~covered][0]
        thin = float(film.thinnest(np.array([x, y])))
        raise OutsideFilm(
            f"a journal {np.hypot(x, y):.3f} clearances from the bearing's centre, at "
            f"{np.degrees(np.arctan2(y, x)):.0f}°: its film is {thin:.3f} clearances thin, and none is known that is "
            f"thinner than {THINNEST_KNOWN:g}"
        )


def slenderness_within(slenderness: float) -> float:
    """Return a ratio of length to diameter, rounded so that equal bearings share tables.

    Args:
        slenderness: Length over diameter [-].

    Returns:
        The ratio [-].

    Raises:
        InvalidSlenderness: No bearing has it.
    """
    if not 0.05 <= slenderness <= 20.0:
        raise InvalidSlenderness(f"length over diameter is {slenderness:g}: usual are 0.3 to 1.2, possible 0.05 to 20")
    return round(float(slenderness), 9)


class _AlikePads:
    """Pads of one arc, which have one table: P of them are computed at once."""

    def __init__(self, pads: Sequence[Pad]) -> None:
        self.closing = np.array([one.closing for one in pads])
        self.middle = np.array([one.middle for one in pads])
        self.full = pads[0].arc == FULL_ARC

    def polar(self, position: Floats) -> tuple[Floats, Floats, Floats]:
        """Return ε and φ (..., P) from the middle of each pad, and the axes (..., P, 2, 2), columns radial and tangential."""
        place = np.asarray(position, dtype=float)[..., None, :] + self.closing
        eccentricity = np.hypot(place[..., 0], place[..., 1])
        central = eccentricity < _AT_CENTRE
        radial = np.where(central[..., None], _TO_X, place / np.where(central, 1.0, eccentricity)[..., None])
        axes = np.empty((*radial.shape, 2))
        axes[..., 0], axes[..., 0, 1], axes[..., 1, 1] = radial, -radial[..., 1], radial[..., 0]
        if self.full:
            return eccentricity, np.zeros_like(eccentricity), axes
        turned = np.arctan2(radial[..., 1], radial[..., 0]) - self.middle
        return eccentricity, np.asarray((turned + np.pi) % (2.0 * np.pi) - np.pi), axes


def _film_of_pads(table: PadTable, eccentricity: Floats, direction: Floats, axes: Floats) -> tuple[Floats, ...]:
    """Return the sum over pads of forces, stiffness, damping and the derivatives of these two."""
    film = table.at(eccentricity, direction)
    stiffness, stiffness_by = _stiffness(film, eccentricity)
    damping, damping_by = _damping(film)
    over = np.where(eccentricity < _AT_CENTRE, 0.0, 1.0 / np.maximum(eccentricity, _AT_CENTRE))
    return (
        np.einsum("...pia,...pa->...i", axes, eccentricity[..., None] * film.force_ratio),
        _summed(axes, stiffness),
        _summed(axes, damping),
        _slopes(axes, stiffness, stiffness_by, over),
        _slopes(axes, damping, damping_by, over),
    )


def _summed(axes: Floats, value: Floats) -> Floats:
    """Return the sum over pads (..., 2, 2) of a matrix with components in turning axes."""
    return np.asarray((axes @ value @ np.swapaxes(axes, -1, -2)).sum(axis=-3))


def _matrix(rr: Floats, rt: Floats, tr: Floats, tt: Floats) -> Floats:
    found = np.empty((*rr.shape, 2, 2))
    found[..., 0, 0], found[..., 0, 1], found[..., 1, 0], found[..., 1, 1] = rr, rt, tr, tt
    return found


def _stiffness(film: PolarFilm, eccentricity: Floats) -> tuple[Floats, tuple[Floats, Floats]]:
    """Return K (..., 2, 2) in the axes radial and tangential, and the derivatives of its components by ε and φ.

    F = ε g in axes that turn with φ: -∂F/∂ε is the radial column, -(1/ε) ∂F/∂φ the tangential one.
    """
    e = eccentricity
    radial, tangential = film.force_ratio[..., 0], film.force_ratio[..., 1]
    (radial_e, tangential_e), (radial_f, tangential_f) = (
        (film.first[..., one, 0], film.first[..., one, 1]) for one in range(2)
    )
    (radial_ee, tangential_ee), (radial_ef, tangential_ef), (radial_ff, tangential_ff) = (
        (film.second[..., one, 0], film.second[..., one, 1]) for one in range(3)
    )
    value = _matrix(radial + e * radial_e, radial_f - tangential, tangential + e * tangential_e, tangential_f + radial)
    by_e = _matrix(
        2.0 * radial_e + e * radial_ee,
        radial_ef - tangential_e,
        2.0 * tangential_e + e * tangential_ee,
        tangential_ef + radial_e,
    )
    by_f = _matrix(
        radial_f + e * radial_ef, radial_ff - tangential_f, tangential_f + e * tangential_ef, tangential_ff + radial_f
    )
    return -value, (-by_e, -by_f)


def _damping(film: PolarFilm) -> tuple[Floats, tuple[Floats, Floats]]:
    """Return C (..., 2, 2) in the axes radial and tangential, as `PadFilm.damping`, with the derivatives of its components."""

    def whole(radial_damping: Floats, force_ratio: Floats) -> Floats:
        cross = 2.0 * force_ratio[..., 0]
        return _matrix(radial_damping, cross, cross, 2.0 * force_ratio[..., 1])

    by = [whole(film.damping_first[..., one], film.first[..., one, :]) for one in range(2)]
    return whole(film.damping, film.force_ratio), (by[0], by[1])


def _slopes(axes: Floats, value: Floats, by: tuple[Floats, Floats], over: Floats) -> Floats:
    """Return the sum over pads of the derivatives (..., 2, 2, 2) by the position of a matrix in turning axes."""
    turning = _TURN @ value - value @ _TURN + by[1]
    # By each of the two local directions c: axes · local_c · axesᵀ; then the directions are turned too.
    local = np.empty((*turning.shape[:-2], 2, 2, 2))
    local[..., 0, :, :], local[..., 1, :, :] = by[0], over[..., None, None] * turning
    turned = axes[..., None, :, :] @ local @ np.swapaxes(axes, -1, -2)[..., None, :, :]
    return np.asarray(np.einsum("...pkc,...pcij->...ijk", axes, turned))
