"""Parts of a machine document that describe a bearing by its film: geometry, oil and elevation; and static loads.

Whoever gives a bearing a `film` gets its static load, the journal's position and the film's coefficients computed.
"""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from estimator.field_types import Angle, Identifier, Length, NotNegative, Part, Positive, Real

LARGEST_CLEARANCE = 0.1
"""Largest radial clearance, as a part of the radius [-]."""
LARGEST_VISCOSITY = 10.0
"""Largest dynamic viscosity of an oil in a bearing [Pa s]; more was meant in mPa s."""
Profile = Literal["plain", "two_axial_grooves", "elliptical", "three_lobe", "four_lobe"]


class Oil(Part):
    """An oil in a film: its viscosity, or the grade and the temperature that give it."""

    viscosity: Positive | None = Field(default=None, description="dynamic viscosity [Pa s], such as 0.02")
    iso_vg: Literal[10, 15, 22, 32, 46, 68, 100, 150, 220, 320, 460, 680] | None = Field(
        default=None, description="ISO VG grade (ISO 3448)"
    )
    temperature_c: Annotated[float, Field(ge=-20, le=180)] | None = Field(default=None, description="of the film [°C]")

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        if (self.viscosity is None) == (self.iso_vg is None):
            raise ValueError("an oil needs either viscosity [Pa s] or iso_vg with temperature_c [°C]")
        if self.viscosity is not None and self.viscosity > LARGEST_VISCOSITY:
            raise ValueError(f"viscosity {self.viscosity} Pa s: turbine oil has 0.005 to 0.1 Pa s; were mPa s meant?")
        if (self.iso_vg is None) != (self.temperature_c is None):
            raise ValueError("iso_vg needs temperature_c [°C], the film's mean temperature, and goes with nothing else")
        return self


class JournalFilm(Part):
    """The oil film of a journal bearing."""

    diameter: Length = Field(description="of the journal [m]")
    length: Length = Field(description="axial length of the pads [m]")
    radial_clearance: Positive = Field(
        description="radius of the pads' curvature less the journal's radius [m]; usual is 0.001 to 0.002 of the radius"
    )
    profile: Profile = Field(default="plain", description="round, or with grooves or lobes")
    preload: Annotated[float, Field(ge=0, lt=1)] = Field(default=0.0, description="of each lobe [-]; 0 for round profiles")
    groove_deg: Annotated[float, Field(gt=0, lt=85)] = Field(default=20.0, description="width of each axial groove [°]")
    turned_deg: Angle = Field(default=0.0, description="angle by which the profile is turned from +x to +y [°]")
    oil: Oil
    elevation_x: Real = Field(default=0.0, description="centre over its aligned place, horizontal [m]")
    elevation_y: Real = Field(default=0.0, description="centre over its aligned place, vertical [m]")
    valid_above_rpm: NotNegative = Field(
        default=0.0, description="below, the journal is lifted by other means, such as jacking oil"
    )

    @model_validator(mode="after")
    def _possible(self) -> Self:
        if self.radial_clearance > LARGEST_CLEARANCE * self.diameter / 2:
            raise ValueError(
                f"radial_clearance {self.radial_clearance} m is more than a tenth of the radius {self.diameter / 2} m; "
                "usual is 0.001 to 0.002 of it"
            )
        if self.preload > 0.0 and self.profile in ("plain", "two_axial_grooves"):
            raise ValueError(f"preload {self.preload} goes with a lobed profile, not with {self.profile}")
        return self


class StaticLoad(Part):
    """A constant force on a shaft, such as that of a gear, of partial admission or of a magnetic pull."""

    id: Identifier
    shaft: Identifier
    station: NotNegative = Field(description="[m] from the shaft's driver-side end")
    force_x: Real = Field(default=0.0, description="[N], horizontal")
    force_y: Real = Field(default=0.0, description="[N], upwards")
