"""Rules on the alignment of trains on oil films: what is allowed at couplings and aimed at, how healthy machines vary."""

import math
from functools import partial
from typing import Annotated, Any, Self

from pydantic import BeforeValidator, Field, model_validator

from estimator.field_types import Identifier, Part, Spread, Within

LARGEST_OFFSET = 0.01
"""Largest offset that a document may allow [m]; more was meant in µm or mm."""
LARGEST_ANGLE = 0.05
"""Largest angle that a document may allow [rad]; more was meant in µrad or mrad."""
LARGEST_IN_THOUSANDTHS = 5.0
"""Largest number that was probably meant in mm or mrad, and not in µm or µrad."""


def _of_unit(value: Any, *, unit: str, largest: float) -> Any:
    """Return an offset or angle that is at most the largest; of a larger one ask whether it is in mm or µm, mrad or µrad."""
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not largest < abs(value) < math.inf:
        return value
    prefix, factor = ("m", 1e-3) if abs(value) <= LARGEST_IN_THOUSANDTHS else ("µ", 1e-6)
    meant = f"was {value:g} {prefix}{unit} meant, {factor * value:g}?"
    raise ValueError(f"{value:g} {unit} is more than {largest:g} {unit}: {meant}")


IN_METRES = BeforeValidator(partial(_of_unit, unit="m", largest=LARGEST_OFFSET))
IN_RADIANS = BeforeValidator(partial(_of_unit, unit="rad", largest=LARGEST_ANGLE))

VariedElevation = Annotated[float, Within(ge=0, le=1e-3, usual=(1e-7, 1e-4))]
"""Standard deviation of an elevation of a healthy machine [m]; more was meant in µm."""


class AlignmentTolerance(Part):
    """Tolerance at one coupling, in either plane; in place of the usual values over speed."""

    coupling: Identifier
    offset: Annotated[float, Within(gt=0, le=LARGEST_OFFSET), IN_METRES] | None = Field(default=None, description="[m]")
    angle: Annotated[float, Within(gt=0, le=LARGEST_ANGLE), IN_RADIANS] | None = Field(default=None, description="[rad]")

    @model_validator(mode="after")
    def _require_content(self) -> Self:
        if self.offset is None and self.angle is None:
            raise ValueError("gives neither offset [m] nor angle [rad]: one is needed")
        return self


Offset = Annotated[float, Within(ge=-LARGEST_OFFSET, le=LARGEST_OFFSET), IN_METRES]
"""Offset of a coupling [m]."""
Turn = Annotated[float, Within(ge=-LARGEST_ANGLE, le=LARGEST_ANGLE), IN_RADIANS]
"""Angle of a coupling [rad]."""


OFFSETS = ("offset_vertical", "offset_horizontal")
"""Fields of a coupling's position that are offsets, not angles."""


class CouplingPosition(Part):
    """Offset and angle of a coupling, or how they grow; signs are those of the alignment that is identified."""

    offset_vertical: Offset | None = Field(default=None, description="[m]")
    offset_horizontal: Offset | None = Field(default=None, description="[m]")
    angle_vertical: Turn | None = Field(default=None, description="[rad]")
    angle_horizontal: Turn | None = Field(default=None, description="[rad]")

    @property
    def stated(self) -> dict[str, float]:
        """Return the given offsets and angles, by name [m, rad]."""
        return {name: value for name in CouplingPosition.model_fields if (value := getattr(self, name)) is not None}


class AlignmentTarget(Part):
    """Target of the alignment at one coupling: as it was left cold, and how it is expected to grow until it works."""

    coupling: Identifier
    left_cold: CouplingPosition
    growth: CouplingPosition = Field(default=CouplingPosition(), description="from cold to hot; without it no hot target")

    @model_validator(mode="after")
    def _grows_from_something(self) -> Self:
        if not self.left_cold.stated:
            raise ValueError("left_cold gives neither an offset [m] nor an angle [rad]: one is needed")
        lacking = [name for name in self.growth.stated if name not in self.left_cold.stated]
        if lacking:
            raise ValueError(f"growth gives {', '.join(lacking)}, of which left_cold does not say where it begins")
        return self


class HealthyVariation(Part):
    """Variation of a healthy machine on oil films, as standard deviations.

    Of stiffness and damping it is that of calibrated machines on any bearings, too.

    Those from run to run are learnt from the baseline, from these on, which count as much as ten runs; that of unbalances as
    much as one component of one run, as each run shows all of them.
    """

    stiffness: Spread = Field(default=0.01, description="of each stiffness from run to run, relative [-]")
    damping: Spread = Field(default=0.05, description="of each damping from run to run, relative [-]")
    oil: Spread = Field(
        default=0.05, description="of the viscosity of all films together from run to run, relative [-]: some 2 K"
    )
    viscosity: Spread = Field(
        default=0.003,
        description="of each film's viscosity by itself from run to run, relative [-]: a part as over the seasons",
    )
    unbalance: Spread = Field(default=0.03, description="of each unbalance from run to run, as a part of it [-]")
    elevation: VariedElevation = Field(default=1e-6, description="of each bearing from run to run, in each direction [m]")
    process_force: Spread = Field(
        default=0.05,
        description="of each static force that is identified from run to run, as a part of what is stated of it [-]",
    )
    slow_oil: Spread = Field(
        default=0.3, description="of the viscosity of all films together over the seasons, relative [-]: some 10 K"
    )
    slow_viscosity: Spread = Field(
        default=0.02, description="of each film's viscosity by itself over the seasons, relative [-]"
    )
    slow_clearance: Spread = Field(default=0.01, description="of each clearance over the seasons, relative [-]")
    slow_elevation: VariedElevation = Field(
        default=2e-6, description="of each bearing over the seasons, in each direction [m]: growth of pedestals"
    )
