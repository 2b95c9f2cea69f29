"""What the API answers with. Times are RFC 3339 in UTC; a value that is not there is null, never NaN."""

from datetime import datetime
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, Field, NonNegativeFloat, PositiveFloat, model_validator

from estimator.machine import Machine
from estimator.written import Written
from service.api.units import Units


class MachineSummary(BaseModel):
    """A machine in a list."""

    id: str
    plant: str
    name: str
    revision: int
    created_at: datetime


class MachineRevision(BaseModel):
    """A machine's document at one revision."""

    id: str
    revision: int
    created_at: datetime
    document: Machine


class PhasorsInUnits(BaseModel):
    """The same in the units asked for; of the 2× and the scatter, too, where `include` asks for them."""

    units: Units
    speed: list[float | None]
    amplitude: list[list[float | None]] = Field(description="per channel; null where unusable")
    phase: list[list[float | None]] = Field(description="per channel, not negative and less than a turn")
    amplitude_2x: list[list[float | None]] | None = None
    phase_2x: list[list[float | None]] | None = Field(default=None, description="of the 2×, less than a turn of it")
    scatter: list[list[float | None]] | None = Field(default=None, description="an amplitude")


Beside = Literal["2x", "scatter", "status"]
"""What comes with the 1× where a source sends it."""


class Phasors(BaseModel):
    """1× phasors in columns; the rows of each table belong to `channels`."""

    machine: str
    revisions: list[int] | None = Field(default=None, description="of the document, whose samples were looked for")
    channels: list[str]
    time: list[datetime]
    speed_rpm: list[float]
    direction: list[str] = Field(description="positive turns +x towards +y")
    amplitude_um_pp: list[list[float | None]] = Field(description="per channel, peak-to-peak [µm]; null where unusable")
    phase_lag_deg: list[list[float | None]] = Field(description="per channel, lag behind the keyphasor [°], 0 to 360")
    amplitude_2x_um_pp: list[list[float | None]] | None = Field(default=None, description="where `include=2x` asks for it")
    phase_2x_lag_deg: list[list[float | None]] | None = Field(default=None, description="in degrees of the 2×")
    scatter_um_pp: list[list[float | None]] | None = Field(
        default=None, description="rms of the complex error of the 1×, where `include=scatter` asks for it; null: not known"
    )
    status: list[list[str]] | None = Field(
        default=None, description="good, not_available, bad or out_of_range, where `include=status` asks for it"
    )
    in_units: PhasorsInUnits | None = Field(default=None, description="where `units` are asked for")
    slow_roll_version: int | None = Field(default=None, description="slow-roll vectors that were subtracted; null: raw")
    slow_roll_left_out: dict[str, str] = Field(default_factory=dict, description="channels left as measured, and why")
    conditions: dict[str, list[float | None]] = Field(
        default_factory=dict, description="operating conditions by name, in the unit of the machine's document"
    )


class RunCoverage(BaseModel):
    """What the samples of a run cover."""

    part: float = Field(description="of the machine's speed range, 0 to 1")
    critical_speeds_rpm: list[float] | None = Field(
        description="of the document's nominal model, between the run's speeds; null until it was identified"
    )
    samples_per_rpm: float
    largest_hole_rpm: float = Field(description="between neighbours in speed")
    usable: dict[str, float] = Field(description="per channel the part of the samples that are good, 0 to 1")
    duration_s: float
    late_samples_left_out: int = Field(description="they came when the run's raw samples were let go of")


class QualitySummary(BaseModel):
    """Quality of a run in short."""

    points: int = Field(description="phasors, samples times channels")
    usable: int
    counts: dict[str, int] = Field(description="phasors by reason")
    findings: list[str] = Field(description="what there is to say of the run, in words")


class ChannelNoise(BaseModel):
    """Noise of a channel as its neighbouring speeds show it; null where there are too few points."""

    relative: float | None = Field(description="part of the amplitude, rms [-]")
    floor: float | None = Field(description="0-to-peak [m]")
    stated: float | None = Field(description="median rms error by the source or the document [m]")
    seen: float | None = Field(description="the same by the neighbouring speeds [m]")
    resolved: bool = Field(description="false where the samples are so sparse that these are bounds from above")


class RunQuality(QualitySummary):
    """Quality of a run, point by point; the rows of `reasons` belong to `channels`."""

    run: int
    judged: bool = Field(description="false until the run's identification was computed")
    meaning: dict[str, str] = Field(description="what each reason that occurs means")
    channels: list[str]
    reasons: list[list[list[str]]] = Field(description="per channel and sample; empty: nothing against it")
    noise: dict[str, ChannelNoise]


class Run(BaseModel):
    """A run-up, a run-down, or a rolling collection over speed bins."""

    id: int
    machine: str
    revision: int
    kind: str
    direction: str
    state: str = Field(
        description="open, ended while its samples are gathered, closed, or discarded as not worth an identification"
    )
    reason: str | None = Field(description="why it ended, and why it was discarded")
    started_at: datetime
    ended_at: datetime | None
    samples: int | None
    speed_minimum_rpm: float | None
    speed_maximum_rpm: float | None
    reopened_at: datetime | None = Field(description="when late samples last made it anew; its newest identification counts")
    samples_released_at: datetime | None = Field(description="when its samples were let go of; null while it has them")
    coverage: RunCoverage | None = Field(description="null until it is closed, and for runs of older releases")
    quality: QualitySummary | None = Field(description="null until it was judged")


class EstimateOut(BaseModel):
    """One estimated parameter with its uncertainty. Null values: the data do not determine it, `reason` says why."""

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
    """A quantity that follows from an identification. Null values: there is none, `reason` says why."""

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
    conditions: dict[str, float | None] | None = Field(
        description="mean of each operating condition over the runs, in the unit of the machine's document"
    )


class IdentificationDetail(IdentificationSummary):
    """One identification with its estimates, what is derived from them and, where asked for, their covariance."""

    estimates: list[EstimateOut]
    derived: list[DerivedOut] = Field(description="critical speeds, coupling loads and the like; none unless it is accepted")
    coordinates: list[str] | None = Field(
        default=None, description="rows of the covariance, in SI; direct terms as logarithms"
    )
    covariance: list[list[float]] | None = None


class JobOut(BaseModel):
    """An identification that is waiting, being computed, done or failed."""

    id: int
    machine: str
    scope: str
    runs: list[int]
    state: str
    attempts: int
    error: str | None
    created_at: datetime
    finished_at: datetime | None
    options: dict[str, Any] | None = Field(description="what differs from the usual")


class IdentificationAsked(Written):
    """How to identify a run again; what is left out stays as usual."""

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


class SourceOut(BaseModel):
    """How far one start of a source has been received."""

    machine: str
    source: str
    epoch: int
    next_sequence: int
    received: int
    duplicates: int
    lost: int
    late: int = Field(description="older than what run collection had seen when they were stored; they reopen runs")
    newest_sample_at: datetime | None = Field(description="when it was measured, by the source's clock")
    newest_received_at: datetime | None = Field(description="when it came, by the service's clock")


class QuarantineEntry(BaseModel):
    """A rejected message or sample."""

    id: int
    received_at: datetime
    key: str
    machine: str | None
    reason: str
    detail: str
    size: int
    payload: str = Field(description="its beginning, with what is not text escaped")


class Quarantine(BaseModel):
    """Rejected input: counts since ever, and the newest entries."""

    counts: dict[str, int]
    entries: list[QuarantineEntry]


class Purged(BaseModel):
    """How many entries of the quarantine were deleted."""

    deleted: int


class Life(BaseModel):
    """Whether the process can still do its work."""

    alive: bool


class Health(BaseModel):
    """Whether each part of the service works, and what is the matter where it does not."""

    healthy: bool
    version: str
    ready: bool
    parts: dict[str, str] = Field(description="`ok`, or what is wrong, per part")
    database: str = Field(description="product and version that keep the data")
    warnings: list[str] = Field(description="what does not hinder the service yet and should be seen to")
    jobs: dict[str, int] = Field(description="identification jobs by state")


class SampleFault(BaseModel):
    """A sample, or one channel's value in it, that was not taken."""

    index: int = Field(description="its place in the batch")
    reason: str
    detail: str


class Submitted(BaseModel):
    """What became of a batch; all of it is durable."""

    received: int = Field(description="samples stored now")
    duplicates: int = Field(description="samples that were stored before")
    missing_before: int = Field(description="sequence numbers left out just before this batch: counted as lost")
    faults: list[SampleFault]
