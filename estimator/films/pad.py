"""Geometry of a pad of a journal bearing."""

import math
from dataclasses import dataclass

from estimator.errors import Invalid

FULL_ARC = 2.0 * math.pi
"""Arc of a pad that surrounds the journal [rad]."""


class InvalidPad(Invalid):
    """Raised when no pad has the geometry given."""


@dataclass(frozen=True)
class Pad:
    """Arc of a bearing's surface with one centre of curvature, axially at a constant radius.

    Angles run from the horizontal x towards y, as the journal turns. The centre of curvature lies away from the bearing's
    centre by preload times clearance, against the direction of the preload: towards there the pad is closer to the journal.
    The clearance is the pad's own (radius of curvature less the journal's radius), not the smallest one of the assembled
    bearing, which is (1 - preload) of it.

    Attributes:
        start: Leading edge, where the journal drags the oil in [rad].
        arc: Extent from there in the sense of rotation; 2π for a bearing without grooves [rad].
        preload: Distance of the centre of curvature from the bearing's centre, in clearances [-].
        preload_direction: Direction in which the preload closes the film [rad]; None for the middle of the pad.
        continuous: Whether the film of a pad of 360° forms again by itself wherever it can. If not, oil comes where the film
            is thickest, at ambient pressure, and it begins there (A. A. Raimondi, J. Boyd, ASLE Trans. 1 (1958) 159).
    """

    start: float
    arc: float
    preload: float = 0.0
    preload_direction: float | None = None
    continuous: bool = False

    def __post_init__(self) -> None:
        if not 0.1 <= self.arc <= FULL_ARC:
            raise InvalidPad(f"a pad of {math.degrees(self.arc):g}°: it must have 6 to 360°")
        if not 0.0 <= self.preload <= 0.9:
            raise InvalidPad(f"a preload of {self.preload:g}: it must be 0 to 0.9")
        if self.is_full and self.preload:
            raise InvalidPad("a pad of 360° with preload: a bearing with preload needs two pads or more")
        if self.continuous and not self.is_full:
            raise InvalidPad(f"a continuous film on a pad of {math.degrees(self.arc):g}°: only one of 360° has it")

    @property
    def is_full(self) -> bool:
        """Return whether the pad surrounds the journal."""
        return self.arc == FULL_ARC

    @property
    def middle(self) -> float:
        """Return the direction of the middle of the pad [rad]."""
        return self.start + self.arc / 2.0

    @property
    def closing(self) -> tuple[float, float]:
        """Return the place of a journal in the bearing's centre relative to the centre of curvature (x, y) [clearances]."""
        direction = self.middle if self.preload_direction is None else self.preload_direction
        return self.preload * math.cos(direction), self.preload * math.sin(direction)
