"""The scale of angles on a machine's discs, in which weights are told by whoever puts them on. Derived here."""

import math
from typing import Literal

from pydantic import Field

from estimator.field_types import Angle, Part


class DiscScale(Part):
    """The scale of angles on the discs, as a person reads it."""

    counted: Literal["x-to-y", "with-rotation", "against-rotation"] = Field(
        default="x-to-y", description="sense in which the numbers on the scale grow"
    )
    zero_deg: Angle = Field(
        default=0.0, description="where the scale's zero is when the keyphasor's pulse comes, from +x towards +y [°]"
    )

    def angle(self, degrees: float, *, direction: int) -> float:
        """Return the angle from +x towards +y of an angle on the scale.

        Args:
            degrees: Angle on the scale [°].
            direction: Sense of rotation, +1 when +x turns to +y, else -1.

        Returns:
            Angle [rad].
        """
        sense = {"x-to-y": 1, "with-rotation": direction, "against-rotation": -direction}[self.counted]
        return math.radians(self.zero_deg + sense * degrees)

    def reading(self, angle: float, *, direction: int) -> float:
        """Return the number on the scale of an angle from +x towards +y.

        Args:
            angle: Angle [rad].
            direction: Sense of rotation, +1 when +x turns to +y, else -1.

        Returns:
            Angle on the scale, 0 to 360 [°].
        """
        sense = {"x-to-y": 1, "with-rotation": direction, "against-rotation": -direction}[self.counted]
        return (sense * (math.degrees(angle) - self.zero_deg)) % 360.0
