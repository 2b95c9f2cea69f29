"""Profiles of journal bearings: the pads' arcs, their centres, and the film thickness over them.

Angles are counted from +x to +y, in the sense in which the journal turns. Lengths are in units of the clearance with which the
pads are machined, c = pad radius - journal radius.
"""

from dataclasses import dataclass

import numpy as np

from tests.film_plant.arrays import Floats


@dataclass(frozen=True)
class Pad:
    """One pad.

    Attributes:
        start: Angle at which the film enters [rad].
        end: Angle at which it leaves [rad].
        preload: Part of the clearance by which the pad is moved towards the journal along its own direction [-].
        direction: Direction from the bearing's centre in which the pad lies [rad].
    """

    start: float
    end: float
    preload: float = 0.0
    direction: float = 0.0

    @property
    def whole(self) -> bool:
        """Return whether the pad is a full ring."""
        return self.end - self.start >= 2.0 * np.pi - 1e-9


@dataclass(frozen=True)
class Profile:
    """A bore: its name and its pads."""

    name: str
    pads: tuple[Pad, ...]

    @property
    def round(self) -> bool:
        """Return whether the film is the same in all directions."""
        return len(self.pads) == 1 and self.pads[0].whole and self.pads[0].preload == 0.0


def _halves(name: str, *, groove: float, preload: float) -> Profile:
    """Two pads, below and above, with grooves of an angle [rad] at either side."""
    lower = Pad(-np.pi + groove / 2, -groove / 2, preload, -np.pi / 2)
    upper = Pad(groove / 2, np.pi - groove / 2, preload, np.pi / 2)
    return Profile(name, (lower, upper))


def _lobes(name: str, count: int, *, below: float, groove: float, preload: float) -> Profile:
    """Equal lobes all around, a groove of an angle [rad] after each; `below`: direction of the first one's middle [rad]."""
    half = np.pi / count - groove / 2
    middles = [below + 2 * np.pi * k / count for k in range(count)]
    return Profile(name, tuple(Pad(middle - half, middle + half, preload, middle) for middle in middles))


PLAIN = Profile("plain", (Pad(-np.pi, np.pi),))
"""A full ring without a groove."""
GROOVED = _halves("grooved", groove=np.radians(20.0), preload=0.0)
"""Two axial grooves of 20° at the sides."""
ELLIPTICAL = _halves("elliptical", groove=np.radians(20.0), preload=0.5)
"""Two pads with preload 0.5 and grooves of 20° at the sides: Lund and Thomsen's."""
THREE_LOBE = _lobes("three_lobe", 3, below=-np.pi / 2, groove=np.radians(20.0), preload=0.4)
"""Three lobes with preload 0.4 and grooves of 20°, the middle of one below the journal."""
FOUR_LOBE = _lobes("four_lobe", 4, below=-np.pi / 4, groove=np.radians(20.0), preload=0.4)
"""Four lobes with preload 0.4 and grooves of 20°, of which one is below the journal."""
PROFILES = {one.name: one for one in (PLAIN, GROOVED, ELLIPTICAL, THREE_LOBE, FOUR_LOBE)}
"""Profiles by name."""


def thickness(pad: Pad, angle: Floats, position: Floats) -> Floats:
    """Film thickness over a pad at angles [rad] with the journal's centre at a position (2,), all in clearances [-]."""
    offset = pad.preload * np.cos(angle - pad.direction)
    return np.asarray(1.0 - offset - position[0] * np.cos(angle) - position[1] * np.sin(angle))


def reach(profile: Profile, direction: Floats) -> Floats:
    """Distances (n,) by which the journal can move in directions (n,) [rad] before it touches a pad [clearances]."""
    found = np.full(direction.shape, np.inf)
    for pad in profile.pads:
        angle = np.linspace(pad.start, pad.end, 721)
        gap = thickness(pad, angle, np.zeros(2))
        along = np.cos(direction[:, None] - angle)
        found = np.minimum(found, np.min(np.where(along > 1e-6, gap / np.maximum(along, 1e-6), np.inf), axis=1))
    return found
