"""The machine document: one rotor train, described once for file, API and storage.

Axes: z along the train from driver to driven, x horizontal, y vertical; positive rotation goes from +x to +y. Lengths in
metres, masses in kilograms and so on (SI), except where a field's name ends in another unit. A *station* is a distance
from the driver-side end of its own shaft [m].
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, Any, Literal, Self

from pydantic import ConfigDict, Field, ValidationError, model_validator

from estimator.errors import Invalid
from estimator.references import reference_problems
from estimator.written import Written

Identifier = Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]{1,64}$", description="letters, digits, '_' and '-', up to 64")]
Text = Annotated[str, Field(pattern=r"^[^\x00]*$")]
"""A text that every store takes."""
# Bounds far beyond any machine: they catch slips of the pen before they become numbers that no arithmetic survives.
Positive = Annotated[float, Field(gt=0, lt=1e15, allow_inf_nan=False)]
Direct = Annotated[float, Field(gt=1e-30, lt=1e15, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0, lt=1e15, allow_inf_nan=False)]
Real = Annotated[float, Field(gt=-1e15, lt=1e15, allow_inf_nan=False)]
Length = Annotated[float, Field(gt=1e-6, lt=100, allow_inf_nan=False)]
Angle = Annotated[float, Field(ge=-3600, le=3600, allow_inf_nan=False)]
Spread = Annotated[float, Field(ge=0, lt=0.5, allow_inf_nan=False)]


class _Part(Written):
    model_config = ConfigDict(frozen=True)


class Material(_Part):
    """An isotropic shaft material."""

    young_modulus: Positive = Field(description="E [N/m²]")
    density: Positive = Field(description="ρ [kg/m³]")
    poisson_ratio: Annotated[float, Field(gt=-1, lt=0.5)] = Field(default=0.3, description="ν [-]")
    young_modulus_spread: Spread = Field(default=0.0, description="how far E may be off, relative rms [-]; 0: known exactly")
    density_spread: Spread = Field(default=0.0, description="how far ρ may be off, relative rms [-]; 0: known exactly")
    internal_damping: Annotated[float, Field(ge=0, lt=1)] = Field(
        default=0.0, description="viscous internal damping over stiffness, β of C = βK in the rotating shaft [s]"
    )


class Section(_Part):
    """A piece of shaft of constant cross-section."""

    length: Length = Field(description="[m]")
    outer_diameter: Length = Field(description="[m]")
    inner_diameter: NotNegative = Field(default=0.0, description="[m]; 0 for a solid shaft")
    material: Identifier

    @model_validator(mode="after")
    def _wall(self) -> Self:
        if self.inner_diameter >= self.outer_diameter:
            raise ValueError(f"inner_diameter {self.inner_diameter} must be smaller than outer_diameter {self.outer_diameter}")
        return self


class Shaft(_Part):
    """One shaft: sections from the driver side to the driven side."""

    id: Identifier
    sections: Annotated[tuple[Section, ...], Field(min_length=1, max_length=200)]
    bow_spread: NotNegative = Field(
        default=0.0, description="how large a residual bow may be at mid-length, rms [m]; 0: straight, no bow is identified"
    )

    @property
    def length(self) -> float:
        """Length of the whole shaft [m]."""
        return math.fsum(section.length for section in self.sections)


class Unbalance(_Part):
    """A residual unbalance: mass times eccentricity, at an angle from the keyphasor mark in the sense +x to +y."""

    magnitude: NotNegative = Field(description="[kg m]")
    angle_deg: Angle = Field(description="[°]")


class Disc(_Part):
    """A rigid disc, which is also the plane in which a residual unbalance is identified."""

    id: Identifier
    shaft: Identifier
    station: NotNegative = Field(description="[m] from the shaft's driver-side end")
    mass: Positive = Field(description="[kg]")
    diametral_inertia: NotNegative = Field(description="I_d [kg m²]")
    polar_inertia: NotNegative = Field(description="I_p [kg m²]")
    unbalance: Unbalance | None = Field(default=None, description="nominal residual unbalance, where known")


class SpeedDependence(_Part):
    """How an element's coefficients follow the speed: through values at some speeds, which are identified.

    Two or more knots: `piecewise` runs straight from knot to knot and stays level outside them, `polynomial` is the one
    polynomial through all of them. Direct terms follow in their logarithm, so that they stay positive.
    """

    form: Literal["polynomial", "piecewise"]
    knots_rpm: Annotated[tuple[Positive, ...], Field(min_length=2, max_length=12)] = Field(description="ascending [r/min]")
    coefficients: tuple[str, ...] | None = Field(default=None, description="which of them, by default all, such as [kxx, kyy]")

    @model_validator(mode="after")
    def _ascending(self) -> Self:
        if any(high <= low for low, high in zip(self.knots_rpm, self.knots_rpm[1:], strict=False)):
            raise ValueError(f"knots_rpm must ascend, not {list(self.knots_rpm)}")
        return self


class LateralCoefficients(_Part):
    """Nominal stiffness and damping over (x, y); leave out what is not known."""

    kxx: Direct | None = Field(default=None, description="[N/m]")
    kxy: Real | None = Field(default=None, description="force along x per displacement along y [N/m]")
    kyx: Real | None = Field(default=None, description="force along y per displacement along x [N/m]")
    kyy: Direct | None = Field(default=None, description="[N/m]")
    cxx: Direct | None = Field(default=None, description="[N s/m]")
    cxy: Real | None = Field(default=None, description="[N s/m]")
    cyx: Real | None = Field(default=None, description="[N s/m]")
    cyy: Direct | None = Field(default=None, description="[N s/m]")
    speed_dependence: SpeedDependence | None = Field(default=None, description="by default the coefficients are constant")


class Bearing(LateralCoefficients):
    """A bearing to ground with eight linear coefficients (thesis Eq. 3.7)."""

    id: Identifier
    shaft: Identifier
    station: NotNegative = Field(description="[m] from the shaft's driver-side end")


class Seal(LateralCoefficients):
    """An annular seal to ground: eight coefficients as a bearing's, and fluid inertia where it is given."""

    id: Identifier
    shaft: Identifier
    station: NotNegative = Field(description="[m] from the shaft's driver-side end")
    mxx: Direct | None = Field(default=None, description="fluid inertia [kg]; identified only where given")
    myy: Direct | None = Field(default=None, description="fluid inertia [kg]; identified only where given")


class Half(_Part):
    """The half of a coupling that sits on one shaft's end: a rigid body."""

    mass: NotNegative = Field(description="[kg]")
    diametral_inertia: NotNegative = Field(default=0.0, description="I_d [kg m²]")
    polar_inertia: NotNegative = Field(default=0.0, description="I_p [kg m²]")


class EquivalentLoad(_Part):
    """Misalignment seen as synchronous forces and moments in a coupling that do not depend on speed.

    Sinha, Lees and Friswell, J. Sound Vib. 272 (2004) 967.
    """

    force_spread: Positive = Field(description="how large a force may be, rms [N]")
    moment_spread: Positive = Field(description="how large a moment may be, rms [N m]")


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


class Probe(_Part):
    """A displacement probe: one measured channel. Its angle is counted from +x towards +y."""

    id: Identifier
    shaft: Identifier
    station: NotNegative = Field(description="[m] from the shaft's driver-side end")
    angle_deg: Angle = Field(description="[°] from +x towards +y: 0 measures x, 90 measures y")
    sensitivity: Positive | None = Field(default=None, description="[V/m]; needed only where a source publishes volts")
    gain_spread: Spread = Field(default=0.0, description="how far gain and phase may be off, relative rms [-]; 0: exact")
    run_out_spread: NotNegative = Field(
        default=0.0, description="how large a run-out that was not subtracted may be, rms [m]; 0: none is identified"
    )


class Condition(_Part):
    """An operating condition that samples may carry beside the phasors, such as load or oil temperature."""

    name: Identifier
    unit: Annotated[Text, Field(min_length=1, max_length=16)] = Field(description="in which it comes, such as degC or %")
    usual_change: Positive | None = Field(
        default=None,
        description="a change that is nothing unusual, in its unit; by default 10 for degC and K, 20 for %, "
        "else its own scatter in the baseline",
    )


class SpeedRange(_Part):
    """Speeds at which samples are taken seriously [r/min]."""

    minimum_rpm: Positive = Field(description="below this a run-down is over")
    maximum_rpm: Positive = Field(description="trip speed or what the machine can never exceed")

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.minimum_rpm >= self.maximum_rpm:
            raise ValueError(f"minimum_rpm {self.minimum_rpm} must be below maximum_rpm {self.maximum_rpm}")
        return self


class Operation(_Part):
    """How the machine is run, as far as its runs cannot be told from the speed alone."""

    stopped_below_rpm: Positive | None = Field(
        default=None, description="below this it stands still [r/min]; by default 1 % of maximum_rpm"
    )
    controlled_deceleration_rpm_per_s: Positive | None = Field(
        default=None,
        description="a run-down from speed that is faster than this is a trip [r/min per s]; by default twice the usual one",
    )
    running_rpm: Positive | None = Field(
        default=None, description="speed at which it works, for loads at running speed [r/min]; by default a run's highest"
    )
    longest_hold_s: Annotated[float, Field(ge=10, le=604_800)] = Field(
        default=3600.0, description="a sweep that stands still on its way for longer, as in a heat soak, is over [s]"
    )
    longest_pause_s: Annotated[float, Field(ge=1, le=86_400)] = Field(
        default=120.0, description="a pause in the data that is longer ends a run [s]"
    )


class RollingCollection(_Part):
    """Bins over the speed range that are filled as the speed wanders, and when they make a run."""

    bins: Annotated[int, Field(ge=5, le=200)] = Field(default=40, description="number of bins over the speed range")
    samples_per_bin: Annotated[int, Field(ge=1, le=50)] = Field(default=5, description="the newest ones kept in each")
    spacing_s: Annotated[float, Field(ge=0, le=86_400)] = Field(
        default=1.0, description="least time between two samples of a bin [s]"
    )
    recency_s: Annotated[float, Field(ge=60, le=31_622_400)] = Field(
        default=604_800.0, description="samples older than this are left out [s]"
    )
    coverage: Annotated[float, Field(gt=0, le=1)] = Field(default=0.6, description="part of the bins that must hold samples")
    interval_s: Annotated[float, Field(ge=10, le=31_622_400)] = Field(
        default=86_400.0, description="at most one run in this time [s]"
    )


class Collection(_Part):
    """How samples become runs."""

    runs: Literal["sweeps", "rolling", "both"] = Field(
        default="sweeps", description="run-ups and run-downs, collections over speed bins, or both"
    )
    pre_trigger_s: Annotated[float, Field(ge=0, le=3600)] = Field(
        default=5.0, description="samples so shortly before a run began belong to it [s]"
    )
    delta_rpm: Positive | None = Field(
        default=None, description="a run keeps a sample when the speed has changed by this [r/min] …"
    )
    delta_s: Positive | None = Field(
        default=None, description="… or when this time has passed since the last one kept [s]; by default every sample"
    )
    rolling: RollingCollection = RollingCollection()


class QualityRules(_Part):
    """Which points of a run an identification leaves out, beside those that no fit should use."""

    sweep_rate: bool = Field(default=True, description="those at which the sweep was too fast for the steady state")
    half_power: bool = Field(default=False, description="those within the half-power points of a resonance, as in thesis §2.3")
    accepted_rpm: tuple[NotNegative, Positive] | None = Field(
        default=None, description="those outside these speeds, the lower one first [r/min]; by default none"
    )

    @model_validator(mode="after")
    def _ascending(self) -> Self:
        if self.accepted_rpm is not None and self.accepted_rpm[0] >= self.accepted_rpm[1]:
            raise ValueError(f"accepted_rpm names the lower speed first, not {list(self.accepted_rpm)}")
        return self


class Noise(_Part):
    """What a phasor's measurement error is expected to be: rms of the complex error, sqrt((relative·|X|)² + floor²)."""

    relative: Annotated[float, Field(gt=0, lt=1)] = Field(default=0.01, description="part of the amplitude [-]")
    floor: NotNegative = Field(default=1e-7, description="0-to-peak [m]")
    estimated: bool = Field(
        default=False, description="find both parts from the fit's own residuals; the values above are where that starts"
    )


class RayleighDamping(_Part):
    """External damping of the shafts, C = αM + βK (thesis Appendix B)."""

    alpha: NotNegative = Field(default=0.0, description="[1/s]")
    beta: NotNegative = Field(default=0.0, description="[s]")


class ParameterRule(_Part):
    """What an identification may do with some parameters. Later rules win over earlier ones."""

    names: Annotated[Text, Field(min_length=1, max_length=200)] = Field(
        description="a parameter's name or a pattern, such as coupling.C1.k_phi*"
    )
    fixed: bool = Field(default=False, description="keep the nominal value")
    spread: Positive | None = Field(
        default=None,
        description="how far from the nominal value, rms: of a direct term's logarithm, else part of the value, or of the "
        "direct terms beside a cross-coupled term of zero",
    )
    tied_to: str | None = Field(default=None, description="element whose coefficients of the same names it takes: bearing.B1")

    @model_validator(mode="after")
    def _one_meaning(self) -> Self:
        if self.fixed + (self.spread is not None) + (self.tied_to is not None) != 1:
            raise ValueError("give exactly one of fixed, spread, tied_to")
        return self


class ImpactTest(_Part):
    """Natural frequencies of the train at standstill, measured with a hammer."""

    frequencies_hz: Annotated[tuple[Positive, ...], Field(min_length=1, max_length=100)]
    relative_error: Annotated[float, Field(gt=0, lt=1)] = Field(default=0.01, description="rms [-]")


class Machine(_Part):
    """One train. The document that a person writes and that everything else in the service is derived from."""

    schema_version: Literal[1] = 1
    id: Identifier
    plant: Identifier
    name: Annotated[Text, Field(min_length=1, max_length=200)]
    rotation: Literal["positive", "negative"] = Field(default="positive", description="positive turns +x towards +y")
    speed_range: SpeedRange
    materials: Annotated[dict[Identifier, Material], Field(min_length=1, max_length=50)]
    shafts: Annotated[tuple[Shaft, ...], Field(min_length=1, max_length=20)]
    discs: Annotated[tuple[Disc, ...], Field(min_length=1, max_length=100)]
    bearings: Annotated[tuple[Bearing, ...], Field(min_length=1, max_length=60)]
    couplings: Annotated[tuple[Coupling, ...], Field(max_length=20)] = ()
    seals: Annotated[tuple[Seal, ...], Field(max_length=60)] = ()
    probes: Annotated[tuple[Probe, ...], Field(min_length=1, max_length=120)]
    conditions: Annotated[tuple[Condition, ...], Field(max_length=16)] = ()
    noise: Noise = Noise()
    operation: Operation = Operation()
    collection: Collection = Collection()
    quality: QualityRules = QualityRules()
    damping: RayleighDamping = Field(default=RayleighDamping(), description="external damping of the shafts")
    parameters: Annotated[tuple[ParameterRule, ...], Field(max_length=200)] = ()
    impact_test: ImpactTest | None = Field(default=None, description="compared with the updated model")
    element_length: Length | None = Field(
        default=None, description="longest shaft element [m]; by default a twelfth of each shaft"
    )

    @model_validator(mode="after")
    def _references(self) -> Self:
        problems = list(reference_problems(self))
        if problems:
            raise ValidationError.from_exception_data("Machine", problems)
        return self

    def describes_the_same_as(self, other: Machine) -> bool:
        """Whether identifications under both documents can be compared: only name and rules of the service differ.

        Operating conditions may come and go, but not change their unit.
        """
        units, others = ({condition.name: condition.unit for condition in one.conditions} for one in (self, other))
        return all(unit == others.get(name, unit) for name, unit in units.items()) and self.is_the_same_train_as(other)

    def is_the_same_train_as(self, other: Machine) -> bool:
        """Whether both documents differ in name, operating conditions and rules of the service only."""
        said = {"name", "conditions", "operation", "collection", "quality", "impact_test"}
        return self.model_dump(exclude=said) == other.model_dump(exclude=said)

    def shaft(self, shaft_id: str) -> Shaft:
        """The shaft of that id. Raises KeyError."""
        for shaft in self.shafts:
            if shaft.id == shaft_id:
                return shaft
        raise KeyError(shaft_id)

    @property
    def direction(self) -> int:
        """+1 when the train turns from +x to +y, else -1."""
        return 1 if self.rotation == "positive" else -1

    @property
    def condition_names(self) -> tuple[str, ...]:
        """Names of the operating conditions in the document's order."""
        return tuple(condition.name for condition in self.conditions)

    @property
    def channels(self) -> tuple[str, ...]:
        """Channel ids in the document's order."""
        return tuple(probe.id for probe in self.probes)


class DocumentError(Invalid):
    """A machine document is wrong. `problems` holds (field, what is wrong and what would be right) pairs."""

    def __init__(self, problems: list[tuple[str, str]]) -> None:
        self.problems = problems
        super().__init__("\n".join(f"{field}: {message}" for field, message in problems))

    @property
    def detail(self) -> str:
        """Say what is wrong as a whole; `field_errors` has the rest."""
        return "the machine document is wrong"

    @property
    def field_errors(self) -> Sequence[tuple[str, str]]:
        """Name each wrong field of the document."""
        return self.problems


def parse_machine(document: Any) -> Machine:
    """The machine that a decoded YAML or JSON document describes.

    Raises DocumentError, which names every wrong field.
    """
    try:
        return Machine.model_validate(document)
    except ValidationError as error:
        raise DocumentError(problems_of(error.errors())) from None


def problems_of(errors: Sequence[Any]) -> list[tuple[str, str]]:
    """(field, message) pairs of pydantic's errors, without those that only follow from another inside the same field."""
    places = [tuple(item["loc"]) for item in errors]

    def follows(item: Any) -> bool:
        place = tuple(item["loc"])
        return item["type"] == "too_short" and any(len(p) > len(place) and p[: len(place)] == place for p in places)

    return [(field_path(item["loc"]), item["msg"]) for item in errors if not follows(item)]


def field_path(location: tuple[int | str, ...]) -> str:
    """`bearings[1].shaft` from ("bearings", 1, "shaft"); the document itself is called `document`."""
    path = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in location)
    return path.removeprefix(".") or "document"
