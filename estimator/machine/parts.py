"""Parts of a rotor train as the machine document describes them: shafts, discs, bearings, pedestals, couplings, probes.

Axes: z along the train from driver to driven, x horizontal, y vertical; positive rotation goes from +x to +y. Lengths in
metres, masses in kilograms and so on (SI), except where a field's name ends in another unit. A *station* is a distance
from the driver-side end of its own shaft [m].
"""

import math
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from estimator.bearings.registry import DeclaredForm
from estimator.field_types import (
    Angle,
    Direct,
    Identifier,
    NotNegative,
    Part,
    Positive,
    Real,
    SmallLength,
    Spread,
    Stiffness,
    Within,
)
from estimator.machine.films import Elevation, JournalFilm

STATION_TOLERANCE = 1e-9
"""Largest distance of two stations that are the same place [m]."""


class Material(Part):
    """An isotropic shaft material."""

    young_modulus: Annotated[float, Within(gt=0, lt=1e15, usual=(1e9, 1e12))] = Field(
        description="E [N/m²]; usual is 2.1e+11 N/m², of steel"
    )
    density: Annotated[float, Within(gt=0, lt=1e15, usual=(1500, 20000))] = Field(
        description="ρ [kg/m³]; usual is 7850 kg/m³, of steel"
    )
    poisson_ratio: Annotated[float, Within(gt=-1, lt=0.5, usual=(0.2, 0.4))] = Field(default=0.3, description="ν [-]")
    young_modulus_spread: Spread = Field(default=0.0, description="how far E may be off, relative rms [-]; 0: known exactly")
    density_spread: Spread = Field(default=0.0, description="how far ρ may be off, relative rms [-]; 0: known exactly")
    internal_damping: Annotated[float, Within(ge=0, lt=1)] = Field(
        default=0.0, description="viscous internal damping over stiffness, β of C = βK in the rotating shaft [s]"
    )


class Section(Part):
    """A piece of shaft of constant cross-section."""

    length: Annotated[float, Within(gt=1e-6, lt=100, usual=(0.005, 5))] = Field(description="[m]")
    outer_diameter: Annotated[float, Within(gt=1e-6, lt=100, usual=(0.01, 2))] = Field(description="[m]")
    inner_diameter: NotNegative = Field(default=0.0, description="[m]; 0 for a solid shaft")
    material: Identifier

    @model_validator(mode="after")
    def _wall(self) -> Self:
        if self.inner_diameter >= self.outer_diameter:
            raise ValueError(f"inner_diameter {self.inner_diameter} must be smaller than outer_diameter {self.outer_diameter}")
        return self


class Shaft(Part):
    """One shaft: sections from the driver side to the driven side."""

    id: Identifier
    sections: Annotated[tuple[Section, ...], Field(min_length=1, max_length=200)]
    bow_spread: SmallLength = Field(
        default=0.0, description="how large a residual bow may be at mid-length, rms [m]; 0: straight, no bow is identified"
    )

    @property
    def length(self) -> float:
        """Return the length of the whole shaft [m]."""
        return math.fsum(section.length for section in self.sections)


class Unbalance(Part):
    """A residual unbalance: mass times eccentricity, at an angle from the keyphasor mark in the sense +x to +y."""

    magnitude: NotNegative = Field(description="[kg m]")
    angle_deg: Angle = Field(description="[°]")


class Disc(Part):
    """A rigid disc, which is also the plane in which a residual unbalance is identified."""

    id: Identifier
    shaft: Identifier
    station: NotNegative = Field(description="[m] from the shaft's driver-side end")
    mass: Positive = Field(description="[kg]")
    diametral_inertia: NotNegative = Field(description="I_d [kg m²]")
    polar_inertia: NotNegative = Field(description="I_p [kg m²]")
    unbalance: Unbalance | None = Field(default=None, description="nominal residual unbalance, where known")


class LateralCoefficients(Part):
    """Nominal stiffness and damping over (x, y); leave out what is not known."""

    kxx: Stiffness | None = Field(default=None, description="[N/m]; usual is 1e+5 to 1e+10 N/m")
    kxy: Real | None = Field(default=None, description="force along x per displacement along y [N/m]")
    kyx: Real | None = Field(default=None, description="force along y per displacement along x [N/m]")
    kyy: Stiffness | None = Field(default=None, description="[N/m]; usual is 1e+5 to 1e+10 N/m")
    cxx: Direct | None = Field(default=None, description="[N s/m]")
    cxy: Real | None = Field(default=None, description="[N s/m]")
    cyx: Real | None = Field(default=None, description="[N s/m]")
    cyy: Direct | None = Field(default=None, description="[N s/m]")
    speed_dependence: DeclaredForm | None = Field(default=None, description="by default the coefficients are constant")


class Bearing(LateralCoefficients):
    """A bearing to ground with eight linear coefficients (thesis Eq. 3.7), and what is known of its film."""

    id: Identifier
    shaft: Identifier
    station: NotNegative = Field(description="[m] from the shaft's driver-side end")
    film: JournalFilm | None = Field(
        default=None, description="geometry and oil of a journal bearing: static loads, positions"
    )
    elevation: Elevation | None = Field(
        default=None, description="of a bearing with coefficients of its own, beside others on films; a film has its own"
    )


class Pedestal(Part):
    """A pedestal under a bearing: a mass on a spring and a damper along x, and along y."""

    id: Identifier
    bearing: Identifier = Field(description="bearing that stands on it")
    kxx: Stiffness = Field(description="[N/m]; usual is 1e+6 to 1e+10 N/m")
    kyy: Stiffness = Field(description="[N/m]; usual is 1e+6 to 1e+10 N/m")
    cxx: Direct = Field(description="[N s/m]")
    cyy: Direct = Field(description="[N s/m]")
    mxx: Direct = Field(description="mass that moves along x [kg]; usual is 0.1 to 10 times the rotor's mass on it")
    myy: Direct = Field(description="mass that moves along y [kg]; usual is 0.1 to 10 times the rotor's mass on it")

    @property
    def speed_dependence(self) -> None:
        """Return None: a pedestal does not depend on the speed."""
        return


class Seal(LateralCoefficients):
    """An annular seal to ground: eight coefficients as a bearing's, and fluid inertia where it is given."""

    id: Identifier
    shaft: Identifier
    station: NotNegative = Field(description="[m] from the shaft's driver-side end")
    mxx: Direct | None = Field(default=None, description="fluid inertia [kg]; identified only where given")
    myy: Direct | None = Field(default=None, description="fluid inertia [kg]; identified only where given")


class Half(Part):
    """The half of a coupling that sits on one shaft's end: a rigid body."""

    mass: NotNegative = Field(description="[kg]")
    diametral_inertia: NotNegative = Field(default=0.0, description="I_d [kg m²]")
    polar_inertia: NotNegative = Field(default=0.0, description="I_p [kg m²]")


class EquivalentLoad(Part):
    """Misalignment seen as synchronous forces and moments in a coupling that do not depend on speed.

    Sinha, Lees and Friswell, J. Sound Vib. 272 (2004) 967.
    """

    force_spread: Positive = Field(description="how large a force may be, rms [N]")
    moment_spread: Positive = Field(description="how large a moment may be, rms [N m]")


class RotatingError(Part):
    """Run-out of a coupling's bore and face, which turns with the shafts: offset and angle that the coupling makes up for."""

    offset_spread: Annotated[float, Within(gt=0, lt=1e15, usual=(1e-6, 1e-3))] = Field(
        default=2e-5, description="how large an offset may be, rms [m]"
    )
    angle_spread: Positive = Field(default=2e-4, description="how large an angle may be, rms [rad]")


class Coupling(LateralCoefficients):
    """A flexible coupling with ten linear coefficients (thesis Eq. 3.9) from the end of one shaft to the start of the next.

    The terms after `k_phiy` are identified only where the document gives them.
    """

    id: Identifier
    driver: Identifier = Field(description="shaft whose driven-side end carries one half")
    driven: Identifier = Field(description="shaft whose driver-side end carries the other half")
    k_phix: Direct | None = Field(default=None, description="moment about x per relative slope about x [N m/rad]")
    k_phiy: Direct | None = Field(default=None, description="moment about y per relative slope about y [N m/rad]")
    k_phixy: Real | None = Field(default=None, description="moment about x per relative slope about y [N m/rad]")
    k_phiyx: Real | None = Field(default=None, description="moment about y per relative slope about x [N m/rad]")
    c_phix: Direct | None = Field(default=None, description="moment about x per relative slope rate about x [N m s/rad]")
    c_phiy: Direct | None = Field(default=None, description="moment about y per relative slope rate about y [N m s/rad]")
    kx_phiy: Real | None = Field(default=None, description="force along x per slope about y, and the moment back [N/rad]")
    ky_phix: Real | None = Field(default=None, description="force along y per slope about x, and the moment back [N/rad]")
    driver_half: Half | None = Field(default=None, description="what sits on the driver's end")
    driven_half: Half | None = Field(default=None, description="what sits on the driven shaft's end")
    load: EquivalentLoad | None = Field(default=None, description="where given, equivalent loads are identified")
    rotating_error: RotatingError | None = Field(
        default=None, description="where given, run-outs of bore and face are identified, which turn with the shafts"
    )


class Probe(Part):
    """A displacement probe: one measured channel. Its angle is counted from +x towards +y."""

    id: Identifier
    shaft: Identifier
    station: NotNegative = Field(description="[m] from the shaft's driver-side end")
    angle_deg: Angle = Field(description="[°] from +x towards +y: 0 measures x, 90 measures y")
    mounted_on: Identifier | None = Field(
        default=None,
        description="bearing on whose pedestal it stands; by default the nearest one of its shaft",
    )
    absolute: bool = Field(default=False, description="stands on the ground: measures the shaft's own motion")
    sensitivity: Positive | None = Field(default=None, description="[V/m]; needed only where a source publishes volts")
    gap_grows: Literal["away", "towards"] | None = Field(
        default=None,
        description="which way the shaft moves while the gap that a source sends grows: away from the probe, as a distance "
        "does, or towards it, as the negative volts of most proximity probes do; needed only where a source sends gaps",
    )
    gain_spread: Annotated[float, Within(ge=0, lt=10, usual=(0.005, 0.5))] = Field(
        default=0.0, description="how far gain and phase may be off, relative rms [-]; 0: exact"
    )
    run_out_spread: SmallLength = Field(
        default=0.0, description="how large a run-out that was not subtracted may be, rms [m]; 0: none is identified"
    )


class RayleighDamping(Part):
    """External damping of the shafts, C = αM + βK (thesis Appendix B)."""

    alpha: NotNegative = Field(default=0.0, description="[1/s]")
    beta: NotNegative = Field(default=0.0, description="[s]")
