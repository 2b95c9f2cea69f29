"""Trial weights as a recording's sidecar states them: how much, in which unit, at which angle of the disc's scale."""

import cmath
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Self

from pydantic import BaseModel, ConfigDict, Field, field_validator, model_validator

from estimator.field_types import Angle, NotNegative, Positive
from estimator.machine.disc_scale import DiscScale
from estimator.unit_names import declared_unit
from estimator.units import KILOGRAM_METRES, KILOGRAMS, RADII, RadiusUnit, WeightUnit

EXAMPLE = "{amount: 48, unit: g mm, angle_deg: 90}"
"""A trial weight as a sidecar states it."""
SMALLEST, LARGEST = 3.0, 3000.0
"""Radii [mm] between which a number without a unit is taken for mm."""
Cell = Callable[[str], float]
"""Function that returns the number in a column of one row."""


FULL_TURN = 2.0 * math.pi + 0.005
"""Largest angle of a column that may be in radians."""
STEP, NEAR_STEP = math.pi / 12.0, 0.002
"""Angle between the places of weights on usual discs [rad], and how near to one a rounded number is."""
FEWEST_ANGLES, LARGE_ANGLE = 3, 3.0
"""Number of different angles with decimals, the largest above 3, that are taken for radians wherever they stand."""


class TrialWeight(BaseModel):
    """A known unbalance that was on a disc: numbers, or names of the columns that hold them."""

    model_config = ConfigDict(extra="forbid", defer_build=True)

    magnitude: NotNegative | None = Field(default=None, description="[kg m]; or amount with its unit")
    amount: NotNegative | str | None = Field(default=None, description="an unbalance or a mass, in `unit`; or a column")
    unit: WeightUnit | None = Field(default=None, description="of amount; a mass needs its radius")
    radius: Positive | None = Field(default=None, description="at which a mass sits")
    radius_unit: RadiusUnit = Field(default="mm", description="of the radius; to be said for one that is unusual in mm")
    angle_deg: Angle | str = Field(description="angle on the disc's scale [°]; or a column")

    @field_validator("unit", mode="before")
    @classmethod
    def _weight_unit(cls, given: object) -> object:
        return declared_unit("weight_unit", given)

    @field_validator("radius_unit", mode="before")
    @classmethod
    def _length_unit(cls, given: object) -> object:
        return declared_unit("radius_unit", given)

    @model_validator(mode="before")
    @classmethod
    def _listed(cls, given: object) -> object:
        if isinstance(given, cls):
            return given
        if not isinstance(given, dict):
            raise ValueError(f"what was on a disc is given with its unit and angle, as in {EXAMPLE}")
        for name in ("magnitude", "amount"):
            size = given.get(name)
            if isinstance(size, int | float) and size < 0.0:
                raise ValueError(f"{name} is {size:g}: a weight is above zero; on the opposite side its angle differs by 180°")
        return given

    @model_validator(mode="after")
    def _whole(self) -> Self:
        if (self.magnitude is None) == (self.amount is None):
            raise ValueError("give either magnitude [kg m], or amount with its unit")
        if (self.amount is None) != (self.unit is None):
            units = ", ".join([*KILOGRAM_METRES, *KILOGRAMS])
            raise ValueError(f"amount and unit go together; the unit is one of {units}")
        if (self.unit in KILOGRAMS) != (self.radius is not None):
            raise ValueError(
                "a mass (g, oz, kg) needs the radius at which it sits, an unbalance (g mm, g in, oz in, kg m) has none"
            )
        unsaid = self.radius is not None and "radius_unit" not in self.model_fields_set
        if self.radius is not None and unsaid and not SMALLEST <= self.radius <= LARGEST:
            raise ValueError(
                f"radius: {self.radius:g} without radius_unit is taken in mm, which is no place for a weight: give "
                "radius_unit, one of mm, in, m"
            )
        if self.magnitude == 0.0 or self.amount == 0.0:
            raise ValueError("a trial weight of zero is none: leave the disc out, or write `added_unbalance: none`")
        return self

    def unbalance(self, cell: Cell, scale: DiscScale, *, direction: int) -> complex:
        """Return the unbalance in one row [kg m], its angle from +x towards +y when the keyphasor's pulse comes."""
        angle = cell(self.angle_deg) if isinstance(self.angle_deg, str) else self.angle_deg
        return cmath.rect(self._kilogram_metres(cell), scale.angle(angle, direction=direction))

    def _kilogram_metres(self, cell: Cell) -> float:
        if self.amount is None or self.unit is None:
            return self.magnitude or 0.0
        amount = cell(self.amount) if isinstance(self.amount, str) else self.amount
        if self.radius is None:
            return amount * KILOGRAM_METRES[self.unit]
        return amount * KILOGRAMS[self.unit] * self.radius * RADII[self.radius_unit]


def require_likely_columns(weight: TrialWeight, columns: Mapping[str, Sequence[float]]) -> None:
    """Raise ValueError where columns hold a weight below zero, or angles in radians.

    columns: values of each column that the weight names, row by row.
    """
    amounts = columns[weight.amount] if isinstance(weight.amount, str) else None
    for row, amount in enumerate(amounts or ()):
        if amount < 0.0:
            raise ValueError(
                f"column '{weight.amount}' is {amount:g} in row {row + 1}: a weight is not below zero; on the opposite side "
                "its angle differs by 180°"
            )
    if isinstance(weight.angle_deg, str):
        angles = columns[weight.angle_deg]
        shown = {angle for row, angle in enumerate(angles) if angle != 0.0 and (amounts is None or amounts[row] != 0.0)}
        if _are_radians(shown):
            listed = ", ".join(f"{one:g}" for one in sorted(shown)[:4])
            raise ValueError(
                f"column '{weight.angle_deg}' holds angles such as {listed}, as radians are: `angle_deg` is in degrees, so "
                f"{max(shown):g} rad is {math.degrees(max(shown)):.4g}. Convert the column, or add 360 to angles that are "
                "degrees indeed"
            )


def _are_radians(angles: set[float]) -> bool:
    """Return whether angles, zero left out, are numbers of radians rather than of degrees."""
    if not angles or max(map(abs, angles)) > FULL_TURN or all(one == int(one) for one in angles):
        return False
    if all(abs(one / STEP - round(one / STEP)) * STEP <= NEAR_STEP for one in angles):
        return True
    return len(angles) >= FEWEST_ANGLES and max(map(abs, angles)) > LARGE_ANGLE
