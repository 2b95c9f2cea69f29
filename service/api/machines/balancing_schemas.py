"""Requests and answers of field balancings."""

import math
from datetime import datetime
from typing import Annotated, Literal, Self

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator

from estimator.balancing.balance_quality import GRAM_MILLIMETRE, PlaneVerdict
from estimator.balancing.balancing_check import LimitVerdict
from estimator.balancing.criterion import Criterion
from estimator.field_types import Identifier
from estimator.machine.disc_scale import DiscScale
from estimator.strict_model import StrictModel
from estimator.units import KILOGRAM_METRES, KILOGRAMS, WeightUnit
from service.api.conventions.fields import Comment, NonBlankText
from service.balancing.stored_runs import StoredWeight
from service.security.principal import Author

DiscAngle = Annotated[
    float, Field(ge=-3600, le=3600, allow_inf_nan=False, description="on the disc's scale [°]; see `disc_scale`")
]
SMALLEST = 1e-6
"""Smallest amount of a weight, in any unit."""
MOST_INITIAL = 20
"""Largest number of initial runs of a balancing."""
Size = Annotated[float, Field(ge=1e-6, le=1e9, allow_inf_nan=False)]
RunNumber = Annotated[int, Field(ge=0, le=2**62)]


def _not_negative(value: object) -> object:
    """Return what stands for an amount. Raises ValueError for one below zero."""
    if isinstance(value, int | float) and value < 0.0:
        raise ValueError("a weight is above zero; on the opposite side its angle differs by 180°")
    return value


class WeightIn(StrictModel):
    """A weight on a disc: an unbalance, or a mass at a radius."""

    disc: Identifier
    amount: Annotated[float, Field(ge=0.0, le=1e9, allow_inf_nan=False), BeforeValidator(_not_negative)] = Field(
        description="an unbalance or a mass, in `unit`; not zero"
    )
    unit: WeightUnit
    radius_mm: Size | None = Field(default=None, description="at which a mass sits [mm]")
    angle_deg: DiscAngle

    @model_validator(mode="after")
    def _whole(self) -> Self:
        if self.amount < SMALLEST:
            raise ValueError("a weight of zero is none: leave it out; `weights: []` where there was none")
        if (self.unit in KILOGRAMS) != (self.radius_mm is not None):
            raise ValueError("a mass (kg, g, oz) needs its radius_mm; an unbalance (g mm, kg mm, g in, oz in, kg m) has none")
        return self

    def stored(self, scale: DiscScale, direction: int) -> StoredWeight:
        """Return the weight as the store holds it. direction: sense of rotation, +1 from +x to +y, else -1."""
        return StoredWeight(self.disc, self.g_mm, math.degrees(scale.angle(self.angle_deg, direction=direction)))

    @property
    def g_mm(self) -> float:
        """Return the unbalance [g mm]."""
        if self.radius_mm is None:
            return self.amount * KILOGRAM_METRES[self.unit] / GRAM_MILLIMETRE
        return self.amount * KILOGRAMS[self.unit] * 1e-3 * self.radius_mm / GRAM_MILLIMETRE


EXAMPLE = '[{"disc": "D1", "amount": 48, "unit": "g mm", "angle_deg": 90}]'


def _listed(value: object) -> object:
    """Return what stands for a list of weights. Raises ValueError for what is none, such as None where it is missing."""
    if not isinstance(value, list):
        raise ValueError(f"weights are a list such as {EXAMPLE}; `[]` where there was none")
    return value


def _loaded(value: object) -> object:
    """Return the value if it is a list with at least one weight. Raises ValueError otherwise."""
    if not isinstance(value, list) or not value:
        raise ValueError(
            f"a trial run needs the weights that were on, a list such as {EXAMPLE}; a run without any is an initial one"
        )
    return value


def _initial(value: object) -> object:
    """Return the value if it lists runs, each once. Raises ValueError otherwise."""
    if isinstance(value, list) and not value:
        raise ValueError("a balancing begins with a run of the machine as it is, before any trial weight, such as [41]")
    shown = value[:MOST_INITIAL] if isinstance(value, list) else []
    twice = [run for place, run in enumerate(shown) if run in shown[:place]]
    if twice:
        raise ValueError(f"run {twice[0]} stands twice among the initial runs: each counts once")
    return value


def _chosen(value: object) -> object:
    """Return the value unless it is an empty list of discs. Raises ValueError for that."""
    if value == []:
        raise ValueError("a correction needs a disc; without `discs` it takes all that had a trial weight")
    return value


def _speeds(value: object) -> object:
    """Return the value unless it is an empty list of speeds. Raises ValueError for that."""
    if value == []:
        raise ValueError("a correction needs a speed; without `speeds_rpm` it takes some that the runs share")
    return value


BalancingSpeeds = Annotated[list[Size], BeforeValidator(_speeds), Field(min_length=1, max_length=100)]
Weights = Annotated[list[WeightIn], BeforeValidator(_listed), Field(max_length=100)]


def required(*names: str) -> ConfigDict:
    """Return the settings of a request whose fields of these names are required, though a validator words their absence."""
    return ConfigDict(json_schema_extra={"required": list(names)})


class BalancingIn(StrictModel):
    """The beginning of a balancing: runs of the machine as it is, before any trial weight."""

    runs: Annotated[list[RunNumber], BeforeValidator(_initial), Field(min_length=1, max_length=MOST_INITIAL)]
    disc_scale: DiscScale = Field(
        default=DiscScale(),
        description="on which all angles of weights are said; by default from the keyphasor mark, +x to +y",
    )
    comment: Comment = ""
    by: Author


class TrialIn(StrictModel):
    """A run with trial weights: all that was on, also what an earlier trial left."""

    model_config = required("run", "weights", "by")

    run: RunNumber
    weights: Annotated[list[WeightIn], BeforeValidator(_loaded), Field(min_length=1, max_length=100)] = Field(
        default=None, validate_default=True
    )
    by: Author


class WithdrawalIn(StrictModel):
    """A trial run to take back, and why."""

    run: RunNumber
    with_correction: bool = Field(
        default=False, description="whether to give up the correction that was computed from it, and its check run, too"
    )
    comment: NonBlankText = Field(description="why")
    by: Author


class PlacesIn(StrictModel):
    """Evenly spaced places of a disc where weights can sit."""

    count: int = Field(ge=1, le=1000)
    radius_mm: Size
    first_deg: DiscAngle = 0.0
    largest_g: Size | None = Field(default=None, description="largest mass at one place [g]")
    step_g: Size | None = Field(default=None, description="step of the masses [g]")


class CorrectionIn(StrictModel):
    """Bounds of a correction, and the grade by which it is judged."""

    discs: Annotated[Annotated[list[Identifier], Field(min_length=1, max_length=100)] | None, BeforeValidator(_chosen)] = (
        Field(default=None, description="discs to correct in; by default all that had a trial weight")
    )
    criterion: Criterion = Field(default="least-squares", description="of the vibration: least squares, or least largest")
    limits_g_mm: Annotated[dict[Identifier, Size], Field(max_length=100)] = Field(
        default_factory=dict, description="largest correction by disc [g mm]"
    )
    places: Annotated[dict[Identifier, PlacesIn], Field(max_length=100)] = Field(default_factory=dict)
    grade: Annotated[float, Field(gt=0, le=1e4, allow_inf_nan=False)] = Field(
        default=2.5, description="balance quality grade G asked for, ISO 21940-11 [mm/s]"
    )
    service_rpm: Size | None = Field(default=None, description="inside the speed range, by default its end [r/min]")
    speeds_rpm: BalancingSpeeds | None = Field(
        default=None,
        description="speeds to balance at, as the runs have them [r/min]; by default those at which channels respond most, "
        "and others that cover the range",
    )
    identification: RunNumber | None = Field(
        default=None, description="one whose model is used, alone or corrected, where it clearly predicts runs left out better"
    )
    by: Author


class CheckIn(StrictModel):
    """The run after the correction."""

    run: RunNumber
    weights: Weights | None = Field(default=None, description="all that is on; by default the weights that were proposed")
    by: Author


class WeightOut(BaseModel):
    """An unbalance on a disc."""

    disc: str
    g_mm: float
    angle_deg: float = Field(description="from the keyphasor mark, +x to +y [°]")
    scale_deg: float = Field(description="the same on the disc's scale [°]")


class TrialOut(BaseModel):
    """A trial run with all weights that were on."""

    run: int
    weights: list[WeightOut]
    by: str


class WithdrawnTrialOut(TrialOut):
    """A trial run that was taken back: it takes part in nothing."""

    withdrawn_by: str
    comment: str = Field(description="why")
    at: datetime
    given_up: list[WeightOut] = Field(description="the correction that was given up with it; empty where none stood")


class PlacedMass(BaseModel):
    """A mass at a place of a disc."""

    angle_deg: float = Field(description="from the keyphasor mark, +x to +y [°]")
    scale_deg: float = Field(description="the same on the disc's scale [°]")
    grams: float


class CorrectionPlaneOut(WeightOut):
    """An unbalance to add to a disc, with 95 % intervals."""

    lower_g_mm: float
    upper_g_mm: float
    half_width_deg: float = Field(description="half the interval of the angle; 180 where any angle is possible [°]")
    masses: list[PlacedMass] = Field(description="at the places of the disc, where these are known")
    missed: float | None = Field(description="part of the best unbalance that the places miss")


class ChannelEffectOut(BaseModel):
    """Largest vibration of a channel over the speeds, as it was and as it is promised."""

    channel: str
    before_um_pp: float
    after_um_pp: float
    upper_um_pp: float = Field(description="95 % bound: what the next run will stay below")


class ResidualOut(BaseModel):
    """Residual unbalance in a bearing plane as that of a rigid rotor, by ISO 21940-11."""

    g_mm: float | None = Field(description="null where it is not known")
    upper_g_mm: float | None
    reached_grade: float | None
    verdict: PlaneVerdict
    untold: str = Field(default="", description="why it is not known, in words")


class ResidualPlaneOut(BaseModel):
    """A bearing plane before and after a correction."""

    shaft: str
    bearing: str
    permissible_g_mm: float
    before: ResidualOut
    after: ResidualOut


class CheckedPlaneOut(ResidualOut):
    """A bearing plane as the check run shows it."""

    shaft: str
    bearing: str
    permissible_g_mm: float


class VectorOfRun(BaseModel):
    """A vector of one run."""

    name: str
    amplitude_um_pp: float
    lag_deg: float


class PredictedVector(BaseModel):
    """A predicted vector."""

    amplitude_um_pp: float
    lag_deg: float


class PointVectors(BaseModel):
    """Vectors at one measuring point, a channel at a speed."""

    point: str
    channel: str
    runs: list[VectorOfRun]
    predicted: PredictedVector
    radius_um_pp: float = Field(description="of the prediction's 95 % circle")


class CorrectionOut(BaseModel):
    """A proposed correction, and what it will leave."""

    by: str
    at: datetime
    speeds_rpm: list[float]
    criterion: str
    grade: float
    service_rpm: float
    influence: str = Field(description="method of the influence coefficients, and how well it predicts runs left out")
    notes: list[str]
    planes: list[CorrectionPlaneOut]
    channels: list[ChannelEffectOut]
    limit_um_pp: float | None = Field(description="the document's vibration limit")
    limit_verdict: LimitVerdict | None
    residual: list[ResidualPlaneOut]
    vectors: list[PointVectors]


class CheckedChannelOut(BaseModel):
    """Largest vibration of a channel in the check run, and whether the prediction for the weights that were on was kept."""

    channel: str
    check_um_pp: float | None
    upper_um_pp: float | None = Field(
        default=None, description="95 % bound predicted for the weights that were on; null for a check run of an older release"
    )
    kept: bool | None = Field(description="whether the check run lies below it")


class CheckedVector(PredictedVector):
    """A vector of the check run at a measuring point."""

    point: str


class TrimOut(WeightOut):
    """An unbalance to add to the weights that are on, with 95 % intervals; null for a check run of an older release."""

    lower_g_mm: float | None = None
    upper_g_mm: float | None = None
    half_width_deg: float | None = Field(default=None, description="half the interval of the angle [°]")


class CheckOut(BaseModel):
    """A check run beside what was promised for the weights that are on."""

    by: str
    at: datetime
    run: int
    weights: list[WeightOut] | None = Field(description="null: those that were proposed")
    points: int
    points_kept: int
    other_weights: bool | None = Field(
        default=None,
        description="whether the weights that were on differ from those proposed by more than a tenth, so that the promise of "
        "the correction is not for them; null for a check run of an older release",
    )
    channels: list[CheckedChannelOut]
    limit_met: bool | None
    residual: list[CheckedPlaneOut]
    unpredicted: list[str] = Field(
        default_factory=list,
        description="discs that had weights and no trial run: nothing is predicted for the run then, and no point is kept",
    )
    trim: list[TrimOut] = Field(description="what to add to the weights that are on; empty where `trim_is_noise`")
    trim_is_noise: bool | None = Field(
        default=None, description="whether nothing to trim can be told from noise; null for a check run of an older release"
    )
    vectors: list[CheckedVector]


class BalancingOut(BaseModel):
    """A field balancing with the steps taken so far."""

    id: int
    machine: str
    revision: int
    state: Literal["begun", "tried", "proposed", "checked"]
    by: str
    comment: str
    created_at: datetime
    updated_at: datetime
    disc_scale: DiscScale
    initial: list[int] = Field(description="runs before any trial weight")
    trials: list[TrialOut]
    withdrawn: list[WithdrawnTrialOut] = Field(description="trial runs that were taken back, in this order")
    correction: CorrectionOut | None
    check: CheckOut | None
