"""Profiles of journal bearings: plain, with two axial grooves, elliptical, with three and with four lobes.

Angles [rad] run from the horizontal x towards y, in the journal's sense of rotation.
"""

import math
from dataclasses import dataclass

from estimator.films.pad import FULL_ARC, InvalidPad, Pad

USUAL_GROOVE = math.radians(20.0)
"""Width of an axial groove where nothing else is known, as of Lund and Thomsen's tables [rad]."""


@dataclass(frozen=True)
class BearingProfile:
    """Pads of one bearing, of the same clearance and length.

    Attributes:
        pads: The pads.
    """

    pads: tuple[Pad, ...]

    def __post_init__(self) -> None:
        if not self.pads:
            raise InvalidPad("a bearing without pads: it needs at least one")
        if sum(pad.arc for pad in self.pads) > FULL_ARC * (1.0 + 1e-9):
            raise InvalidPad("pads that cover more than 360°: their arcs and grooves must share the circumference")


def plain(*, continuous: bool = False) -> BearingProfile:
    """Return a round bearing without grooves.

    Args:
        continuous: Whether the film forms again by itself, instead of where it is thickest, as of `Pad`. At small
            eccentricities this adds up to a sixth to the radial damping.

    Returns:
        The profile.
    """
    return BearingProfile((Pad(0.0, FULL_ARC, continuous=continuous),))


def two_axial_grooves(*, groove: float = USUAL_GROOVE, split: float = 0.0) -> BearingProfile:
    """Return a round bearing with two axial grooves opposite one another.

    Args:
        groove: Width of each groove [rad].
        split: Direction of one groove; 0 where they lie in the horizontal split [rad].

    Returns:
        The profile.
    """
    return elliptical(preload=0.0, groove=groove, split=split)


def elliptical(*, preload: float, groove: float = USUAL_GROOVE, split: float = 0.0) -> BearingProfile:
    """Return an elliptical (lemon-bore) bearing: two lobes, and grooves between them.

    Args:
        preload: Preload of each lobe [-].
        groove: Width of each groove [rad].
        split: Direction of one groove; 0 where they lie in the horizontal split [rad].

    Returns:
        The profile.
    """
    return lobed(2, preload=preload, groove=groove, first=split - math.pi / 2.0)


def three_lobe(*, preload: float, groove: float = USUAL_GROOVE, first: float = -math.pi / 2.0) -> BearingProfile:
    """Return a bearing with three lobes.

    Args:
        preload: Preload of each lobe [-].
        groove: Width of each groove [rad].
        first: Direction of the middle of one lobe; by default below the journal [rad].

    Returns:
        The profile.
    """
    return lobed(3, preload=preload, groove=groove, first=first)


def four_lobe(*, preload: float, groove: float = USUAL_GROOVE, first: float = -math.pi / 4.0) -> BearingProfile:
    """Return a bearing with four lobes.

    Args:
        preload: Preload of each lobe [-].
        groove: Width of each groove [rad].
        first: Direction of the middle of one lobe; by default a groove is below the journal [rad].

    Returns:
        The profile.
    """
    return lobed(4, preload=preload, groove=groove, first=first)


def lobed(lobes: int, *, preload: float, groove: float, first: float) -> BearingProfile:
    """Return a bearing with equal lobes and a groove behind each.

    Args:
        lobes: Number of lobes.
        preload: Preload of each lobe [-].
        groove: Width of each groove [rad].
        first: Direction of the middle of one lobe [rad].

    Returns:
        The profile.

    Raises:
        InvalidPad: A groove leaves no pad.
    """
    pitch = FULL_ARC / lobes
    if not 0.0 < groove < pitch - 0.1:
        raise InvalidPad(
            f"grooves of {math.degrees(groove):g}° between {lobes} lobes: each must be wider than 0 and narrower than "
            f"{math.degrees(pitch - 0.1):.0f}°"
        )
    arc = round(pitch - groove, 12)  # equal lobes share one table
    return BearingProfile(tuple(Pad(first + one * pitch - arc / 2.0, arc, preload) for one in range(lobes)))
