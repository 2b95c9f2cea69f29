"""Models of results of updated models: critical speeds, Campbell diagram, modes, coupling loads, balancing."""

from pydantic import BaseModel, Field

from service.api.conventions.units import OptionalValues, Units


class OfModel(BaseModel):
    """Common first fields of these models."""

    identification: int
    machine: str
    direction: str = Field(description="sense of rotation of the runs, positive turns +x towards +y")
    units: Units


class CriticalSpeedOut(BaseModel):
    """A speed at which a natural frequency equals the spin speed."""

    speed: float
    standard_error: float | None
    lower: float | None = Field(description="of the 95 % interval")
    upper: float | None
    damping_ratio: float
    log_decrement: float
    whirl: float = Field(description="+1 forward to -1 backward")


class CriticalSpeeds(OfModel):
    """Critical speeds, ascending; those too heavily damped to be noticed in passing are left out."""

    highest: float = Field(description="up to which they were looked for")
    critical_speeds: list[CriticalSpeedOut]


class Curve(BaseModel):
    """One mode over the speeds; null where it is overdamped or not followed."""

    frequency_hz: OptionalValues = Field(description="damped natural frequency")
    damping_ratio: OptionalValues
    whirl: OptionalValues


class CampbellOut(OfModel):
    """Natural frequencies over spin speed; a curve crosses the synchronous line at a critical speed."""

    speed: OptionalValues
    synchronous_hz: OptionalValues = Field(description="the frequency of once per turn at each speed")
    curves: list[Curve]
    critical_speeds: list[CriticalSpeedOut] = Field(description="without errors; see critical-speeds")


class Displacement(BaseModel):
    """Complex displacements of the nodes along an axis; the largest semi-major axis of the train is 1."""

    real: list[float]
    imaginary: list[float]


class ShaftShapeOut(BaseModel):
    """A shaft in a mode, at its nodes."""

    shaft: str
    at: list[float] = Field(description="[m] from the train's driver-side end, as in the drawing")
    x: Displacement
    y: Displacement
    semi_major: list[float]
    semi_minor: list[float] = Field(description="positive where the node whirls forward")
    inclination_deg: list[float] = Field(description="of the major axis, from +x towards +y")


class ModeOut(BaseModel):
    """A mode: the motion is Re(q e^{λt})."""

    frequency_hz: float
    standard_error_hz: float | None
    damping_ratio: float = Field(description="negative for a mode that grows")
    log_decrement: float
    whirl: float = Field(description="+1 forward to -1 backward")
    shafts: list[ShaftShapeOut]


class ModesOut(OfModel):
    """Modes at one spin speed, by ascending natural frequency."""

    speed: float
    highest_hz: float
    modes: list[ModeOut]


class Load(BaseModel):
    """The 1× amplitude of a force [N] or moment [N m] over speed, 0-to-peak, with its 95 % band, and its phase."""

    amplitude: OptionalValues
    lower: OptionalValues
    upper: OptionalValues
    phase: OptionalValues


class CouplingLoad(BaseModel):
    """Load in a coupling: it acts on the driven half, and its opposite on the driver half."""

    coupling: str
    force_x: Load
    force_y: Load
    moment_x: Load
    moment_y: Load


class MisalignmentForce(OfModel):
    """Forces [N] and moments [N m] of each coupling over speed. An identified equivalent load is not included."""

    speed: OptionalValues
    couplings: list[CouplingLoad]


class PlaneCorrection(BaseModel):
    """Unbalance to add in a plane."""

    plane: str
    unbalance_g_mm: float
    angle_deg: float = Field(description="from the keyphasor mark, in the sense +x to +y")


class GainedUnbalance(BaseModel):
    """Unbalance that a disc has gained, with 95 % half widths."""

    disc: str
    g_mm: float
    half_width_g_mm: float = Field(description="of its part along any direction")
    angle_deg: float = Field(description="from the keyphasor mark, in the sense +x to +y")
    half_width_deg: float = Field(description="180 where the angle is open")
    clear: bool = Field(description="whether more than the uncertainty and a new mounting explain, at 95 %")


class UnbalanceGained(BaseModel):
    """Unbalance gained since the calibration that the document held.

    The intervals hold the uncertainty of the calibration, of this run and of a new mounting.
    """

    identification: int
    machine: str
    accepted: bool = Field(description="whether the identification passed its tests; else its values are not to be used")
    calibration_runs: list[str] = Field(description="names of the runs that the machine was calibrated with")
    discs: list[GainedUnbalance]


class Vibration(BaseModel):
    """A channel's amplitude over the speeds, with its 95 % band."""

    channel: str
    amplitude: OptionalValues
    lower: OptionalValues
    upper: OptionalValues


class Balancing(OfModel):
    """The correction that minimises the squared vibration over the speeds, and the vibration before and after it."""

    speed: OptionalValues
    corrections: list[PlaneCorrection]
    before: list[Vibration]
    after: list[Vibration] = Field(description="with this very correction")
    condition_number: float = Field(
        description="of the influence coefficients; beyond some hundreds different corrections do nearly the same"
    )


class BodeColumns(BaseModel):
    """A channel over speed."""

    channel: str
    amplitude: OptionalValues
    phase: OptionalValues


class FittedChannel(BodeColumns):
    """A channel's fitted curve with the 95 % band of its amplitude."""

    lower: OptionalValues
    upper: OptionalValues


class MeasuredChannel(BodeColumns):
    """A channel's measured points, as used by the fit, with the residuals at the same speeds."""

    used: list[bool] = Field(description="false for points that quality left out")
    residual: OptionalValues = Field(description="|measured - fitted|, an amplitude")
    residual_sigma: OptionalValues = Field(description="the same over the expected error; null where that is not known")


class FittedCurve(BaseModel):
    """The fit over evenly spaced speeds."""

    speed: OptionalValues
    channels: list[FittedChannel]


class MeasuredRun(BaseModel):
    """The points of a run."""

    run: int
    time: list[str]
    speed: OptionalValues
    channels: list[MeasuredChannel]


class Bode(OfModel):
    """Fit and measurement over speed. Slow-roll vectors that the identification subtracted are subtracted here too."""

    slow_roll_subtracted: bool
    fitted: FittedCurve
    measured: list[MeasuredRun] = Field(description="runs whose samples are still stored")


class MeasuredLine(BaseModel):
    """Places of a journal's centre in its bearing over speed; null where unknown."""

    bearing: str
    x_um: OptionalValues = Field(description="horizontal, from the bearing's centre [µm]")
    y_um: OptionalValues = Field(description="upwards [µm]")


class JournalLine(MeasuredLine):
    """Places of a journal with the circle in which it moves."""

    clearance_um: float = Field(description="radial [µm]")


class MeasuredLines(BaseModel):
    """Lines that the gaps of a run tell."""

    run: int
    speed: OptionalValues
    bearings: list[MeasuredLine] = Field(description="those with two probes across each other that send gaps")


class CentrelineOut(OfModel):
    """Journals in their clearance circles over the speeds of the runs."""

    speed: OptionalValues
    bearings: list[JournalLine]
    measured: list[MeasuredLines] = Field(description="by run with gaps, each probe's zero set by the model")


class CoefficientCurve(BaseModel):
    """A coefficient of an oil film over speed with its 95 % band; null where the data leave it too uncertain."""

    term: str = Field(description="such as kxx")
    unit: str = Field(description="SI unit of value and band")
    value: OptionalValues
    lower: OptionalValues
    upper: OptionalValues


class FilmOverSpeed(BaseModel):
    """The coefficients of one bearing's oil film."""

    bearing: str
    coefficients: list[CoefficientCurve]


class FilmCoefficientsOut(OfModel):
    """Coefficients of oil films, from the lowest speed at which they carry to running speed."""

    speed: OptionalValues
    bearings: list[FilmOverSpeed]
