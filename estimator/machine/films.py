"""Parts of a machine document that describe a bearing by its film: geometry, oil and elevation; and static loads.

Whoever gives a bearing a `film` gets its static load, the journal's position and the film's coefficients computed.
"""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from estimator.field_types import Angle, ElevationSpread, Identifier, NotNegative, Part, Real, Within
from estimator.usual_values import question

LARGEST_CLEARANCE = 0.1
"""Largest radial clearance, as a part of the radius [-]."""
USUAL_CLEARANCE = (0.0005, 0.0035)
"""Usual ratio of the radial clearance, and of what preload leaves of it, to the journal's radius: others are warned of [-]."""
DEFAULT_GROOVE = 20.0
"""Width of an axial groove where the document says nothing [°]."""
LARGEST_PAD_PRELOAD = 0.8
"""Largest preload of tilting pads [-]."""
JournalLength = Annotated[float, Within(gt=1e-6, lt=100, usual=(0.02, 1))]
HeightOrShift = Annotated[float, Within(gt=-1e15, lt=1e15, usual=(-1e-3, 1e-3))]
"""Place of a bearing's centre over its aligned place [m]."""
Profile = Literal["plain", "two_axial_grooves", "elliptical", "three_lobe", "four_lobe", "tilting_pad"]


class Oil(Part):
    """An oil in a film: its viscosity, or its grade with the film's temperature or with that at which the oil comes."""

    viscosity: Annotated[float, Within(gt=0, lt=1e15, usual=(0.002, 0.2))] | None = Field(
        default=None, description="dynamic viscosity [Pa s]; usual is 0.005 to 0.1 Pa s"
    )
    iso_vg: Literal[10, 15, 22, 32, 46, 68, 100, 150, 220, 320, 460, 680] | None = Field(
        default=None, description="ISO VG grade (ISO 3448)"
    )
    temperature_c: Annotated[float, Within(ge=-20, le=180, usual=(10, 120))] | None = Field(
        default=None, description="of the film [°C]"
    )
    inlet_c: Annotated[float, Within(ge=0, le=120, usual=(10, 80))] | None = Field(
        default=None, description="at which the oil comes [°C]: the film is warmer by a heat balance, more so at high speed"
    )
    carried: Annotated[float, Within(gt=0, le=1, usual=(0.5, 1))] = Field(
        default=0.8, description="part of the friction's heat that the oil carries off, where inlet_c is given [-]"
    )
    temperature_from: Identifier | None = Field(
        default=None,
        description="operating condition in degC: of a run its mean takes the place of temperature_c or inlet_c",
    )
    supply: Identifier | None = Field(
        default=None, description="films that name the same one have viscosities that are off by one factor"
    )

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        if (self.viscosity is None) == (self.iso_vg is None):
            raise ValueError("an oil needs either viscosity [Pa s] or iso_vg with temperature_c or inlet_c [°C]")
        warmed = (self.temperature_c is not None) + (self.inlet_c is not None)
        if warmed != (self.iso_vg is not None):
            raise ValueError(
                "iso_vg needs either temperature_c, of the film, usually 40 to 80 °C, or inlet_c, usually 35 to 50 °C, and "
                "these go with nothing else"
            )
        if self.temperature_from is not None and self.iso_vg is None:
            raise ValueError("temperature_from needs iso_vg: a viscosity that is given follows no temperature")
        return self


class TiltingPads(Part):
    """The pads of a tilting-pad bearing, equal and evenly around the journal; their preload is the film's."""

    number: Annotated[int, Field(ge=3, le=12)] = Field(description="of pads; usual is 4 or 5")
    arc_deg: Annotated[float, Within(ge=15, le=120, usual=(20, 120))] = Field(description="of each pad [°]")
    pivot: Annotated[float, Within(ge=0.4, le=0.8, usual=(0.5, 0.6))] = Field(
        default=0.5,
        description="place of the pivot as a part of the arc [-], from the edge where oil enters; 0.5 is the middle",
    )
    load: Literal["on_pad", "between_pads"] = Field(
        description="straight below the journal lies a pivot, or the middle between two; turned_deg turns both"
    )

    @model_validator(mode="after")
    def _side_by_side(self) -> Self:
        if self.number * self.arc_deg > 360.0:
            raise ValueError(
                f"{self.number} pads of {self.arc_deg:g}° overlap: together they must cover at most 360°, usual is 240 to 320°"
            )
        return self


class JournalFilm(Part):
    """The oil film of a journal bearing."""

    diameter: JournalLength = Field(description="of the journal [m]")
    length: JournalLength = Field(description="axial length of the pads [m]")
    radial_clearance: Annotated[float, Within(gt=0, lt=1e15, usual=(1e-5, 2e-3))] = Field(
        description="radius of the pads' curvature less the journal's radius [m]; usual is 0.001 to 0.002 of the radius"
    )
    profile: Profile = Field(default="plain", description="round, with grooves or lobes, or with tilting pads")
    preload: Annotated[float, Within(ge=0, lt=1, usual=(0.1, 0.8))] = Field(
        default=0.0,
        description="of each lobe or tilting pad [-]; 0 for round profiles, usually 0.3 to 0.6 for lobed ones, "
        "0 to 0.5 for tilting pads",
    )
    pads: TiltingPads | None = Field(default=None, description="of profile tilting_pad, which needs them")
    groove_deg: Annotated[float, Within(gt=0, lt=85, usual=(5, 45))] = Field(
        default=DEFAULT_GROOVE, description="width of each axial groove [°], in a two_axial_grooves or lobed profile"
    )
    turned_deg: Angle = Field(
        default=0.0,
        description="angle by which the profile is turned from +x to +y [°]; not turned, grooves of two_axial_grooves and "
        "elliptical lie horizontally, a lobe of three_lobe below the journal, and a groove of four_lobe",
    )
    oil: Oil
    elevation_x: HeightOrShift = Field(default=0.0, description="centre over its aligned place, horizontal [m]")
    elevation_y: HeightOrShift = Field(default=0.0, description="centre over its aligned place, vertical [m]")
    valid_above_rpm: NotNegative = Field(
        default=0.0, description="below, the journal is lifted by other means [r/min], such as jacking oil"
    )

    @model_validator(mode="after")
    def _possible(self) -> Self:
        if self.radial_clearance > LARGEST_CLEARANCE * self.diameter / 2:
            usual = (USUAL_CLEARANCE[0] * self.diameter / 2, USUAL_CLEARANCE[1] * self.diameter / 2)
            raise ValueError(
                f"radial_clearance {self.radial_clearance} m is more than a tenth of the radius {self.diameter / 2} m; "
                f"usual is 0.001 to 0.002 of it{question(self.radial_clearance, 'm', usual)}"
            )
        if self.preload > 0.0 and self.profile in ("plain", "two_axial_grooves"):
            raise ValueError(f"preload {self.preload} goes with a lobed profile or tilting pads, not with {self.profile}")
        return self

    @model_validator(mode="after")
    def _padded(self) -> Self:
        if (self.profile == "tilting_pad") != (self.pads is not None):
            raise ValueError(
                "profile tilting_pad needs pads: {number, arc_deg, pivot, load}"
                if self.pads is None
                else f"pads go with profile tilting_pad, not with {self.profile}"
            )
        if self.pads is not None and self.preload > LARGEST_PAD_PRELOAD:
            raise ValueError(f"preload {self.preload} of tilting pads: it is 0 to {LARGEST_PAD_PRELOAD:g}, usual 0 to 0.5")
        return self


class Elevation(Part):
    """The place of a bearing that is no film itself, in a train of which others are."""

    x: HeightOrShift = Field(default=0.0, description="centre over its aligned place, horizontal [m]")
    y: HeightOrShift = Field(default=0.0, description="centre over its aligned place, vertical [m]")
    spread: ElevationSpread = Field(
        default=1.5e-4, description="how far the centre may be from there, rms, in each direction [m]"
    )


class StaticLoad(Part):
    """A static force on a shaft, such as that of a gear, of partial admission or of a magnetic pull."""

    id: Identifier
    shaft: Identifier
    station: NotNegative = Field(description="[m] from the shaft's driver-side end")
    force_x: Real = Field(default=0.0, description="[N], horizontal")
    force_y: Real = Field(default=0.0, description="[N], upwards")
    force_x_spread: NotNegative = Field(
        default=0.0, description="how far force_x may be off, rms [N]; 0: known exactly, no force is identified"
    )
    force_y_spread: NotNegative = Field(default=0.0, description="how far force_y may be off, rms [N]; 0: known exactly")
    scaled_by: Identifier | None = Field(
        default=None, description="operating condition to which the force is proportional, such as the power; needs stated_at"
    )
    stated_at: Real | None = Field(default=None, description="value of that condition at which the force is as stated here")

    @model_validator(mode="after")
    def _scaled(self) -> Self:
        if (self.scaled_by is None) != (self.stated_at is None):
            raise ValueError("scaled_by, an operating condition, and stated_at, its value for this force, go together")
        if self.stated_at == 0.0:
            raise ValueError("stated_at must not be 0: the force is proportional to the condition")
        return self
