"""Models of identifications, their estimates and their jobs."""

from datetime import datetime
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, Field, NonNegativeFloat, PositiveFloat, model_validator

from estimator.strict_model import StrictModel


class EstimateOut(BaseModel):
    """One estimated parameter with its uncertainty. Null values: the data do not determine it; `reason` says why."""

    parameter: str
    element: str
    quantity: str
    unit: str = Field(description="of all its values: SI, or what `units` asks for in its place")
    value: float | None = Field(description="of an unbalance the part along +x at the keyphasor mark")
    standard_error: float | None
    lower: float | None = Field(description="of the 95 % interval; of an unbalance's magnitude")
    upper: float | None
    imaginary: float | None = Field(default=None, description="of an unbalance")
    imaginary_standard_error: float | None = None
    magnitude: float | None = Field(default=None, description="of an unbalance; lower and upper are its interval")
    angle_deg: float | None = Field(default=None, description="of an unbalance, from the keyphasor mark on, from +x to +y")
    angle_half_width_deg: float | None = Field(
        default=None, description="of the angle's 95 % interval; 180: any angle is possible"
    )
    reason: str | None = None


class DerivedOut(BaseModel):
    """A quantity derived from an identification. Null values: it has none; `reason` says why."""

    name: str
    unit: str = Field(description="of all its values: SI, or what `units` asks for in its place")
    value: float | None
    lower: float | None = Field(description="of the 95 % interval")
    upper: float | None
    reason: str | None


class IdentificationSummary(BaseModel):
    """One identification, without its estimates."""

    id: int
    machine: str
    revision: int
    scope: str = Field(description="run: of one run; gathered: of the newest runs together; variant: of one run, in no trend")
    run_kind: str
    runs: list[int]
    measured_at: datetime
    computed_at: datetime
    accepted: bool
    verdict: str
    chi_square: float
    degrees_of_freedom: int
    condition_number: float
    samples: int
    speed_minimum_rpm: float
    speed_maximum_rpm: float
    starts: int
    iterations: int
    options: dict[str, Any]
    code_version: str
    noise_relative: float | None = Field(description="relative error of a phasor as stated or estimated, rms [-]")
    noise_floor: float | None = Field(description="its floor, 0-to-peak [m]")
    outliers: dict[str, int] | None = Field(description="per channel the phasors left out because no noise explains them")
    slow_roll_version: int | None = Field(description="slow-roll vectors that were subtracted; null: none")
    load_balance: int | None = Field(
        description="version of the balance of loads on oil films beside unknown couplings or pedestals: values of two "
        "versions are not to be compared; null: before the second, or where it does not matter"
    )
    conditions: dict[str, float | None] | None = Field(
        description="mean of each operating condition over the runs, in the unit of the machine's document"
    )


class IdentificationDetail(IdentificationSummary):
    """One identification with its estimates, the quantities derived from them and, on request, their covariance."""

    estimates: list[EstimateOut]
    derived: list[DerivedOut] = Field(description="critical speeds, coupling loads and the like; none unless it is accepted")
    coordinates: list[str] | None = Field(
        default=None, description="rows of the covariance, in SI; direct terms as logarithms"
    )
    covariance: list[list[float]] | None = None


class JobOut(BaseModel):
    """An identification job: waiting, being computed, done or failed."""

    id: int
    machine: str
    scope: str
    runs: list[int]
    state: str
    attempts: int
    error: str | None
    remedy: str | None = Field(default=None, description="what a person can do about the error")
    created_at: datetime
    finished_at: datetime | None
    options: dict[str, Any] | None = Field(description="what differs from the usual")


class IdentificationAsked(StrictModel):
    """Options for identifying a run, or one again; omitted ones keep their usual values."""

    slow_roll: Literal["none", "in_force"] | Annotated[int, Field(ge=1, le=2**62)] = Field(
        default="in_force", description="vectors to subtract: `none`, `in_force` or a version"
    )
    starts: int | None = Field(default=None, ge=1, le=50, description="most starts tried before a misfit is reported")
    seed: int | None = Field(default=None, ge=0, le=2**31, description="of the random starts")
    robust: bool | None = Field(default=None, description="leave out phasors that cannot be noise")
    sweep_rate: bool | None = Field(default=None, description="judge whether the sweep was too fast")
    half_power: bool | None = Field(default=None, description="leave out what lies within half-power points")
    accepted_rpm: tuple[NonNegativeFloat, PositiveFloat] | None = Field(
        default=None, description="the only speeds that count, the lower one first [r/min]"
    )

    @model_validator(mode="after")
    def _ascending(self) -> Self:
        if self.accepted_rpm is not None and self.accepted_rpm[0] >= self.accepted_rpm[1]:
            raise ValueError("accepted_rpm names the lower speed first")
        return self
