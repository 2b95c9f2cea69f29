"""Models of runs, phasors and submitted samples.

Times are RFC 3339 in UTC; a missing value is null, never NaN.
"""

from datetime import datetime
from typing import Literal, Self

from pydantic import BaseModel, Field, model_validator

from estimator.strict_model import StrictModel
from service.api.conventions.fields import Moment
from service.api.conventions.units import Units
from service.security.principal import Author


class PhasorsInUnits(BaseModel):
    """The phasors in the requested units, with the 2× and the scatter where `include` asks for them."""

    units: Units
    speed: list[float | None]
    amplitude: list[list[float | None]] = Field(description="per channel; null where unusable")
    phase: list[list[float | None]] = Field(description="per channel, not negative and less than a turn")
    amplitude_2x: list[list[float | None]] | None = None
    phase_2x: list[list[float | None]] | None = Field(default=None, description="of the 2×, less than a turn of it")
    scatter: list[list[float | None]] | None = Field(default=None, description="an amplitude")
    gap: list[list[float | None]] | None = Field(default=None, description="in the amplitude's unit of length")
    overall: list[list[float | None]] | None = Field(default=None, description="an amplitude")


PhasorExtra = Literal["2x", "scatter", "status", "gap", "overall"]
"""Values that come with the 1× where a source sends them."""


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
    gap_um: list[list[float | None]] | None = Field(
        default=None,
        description="mean place of the shaft on the probe's axis, towards the probe, from a zero of its own [µm], where "
        "`include=gap` asks for it; null: not sent",
    )
    overall_um_pp: list[list[float | None]] | None = Field(
        default=None, description="unfiltered vibration, where `include=overall` asks for it; null: not sent"
    )
    in_units: PhasorsInUnits | None = Field(default=None, description="where `units` are asked for")
    slow_roll_version: int | None = Field(default=None, description="slow-roll vectors that were subtracted; null: raw")
    slow_roll_left_out: dict[str, str] = Field(default_factory=dict, description="channels left as measured, and why")
    conditions: dict[str, list[float | None]] = Field(
        default_factory=dict, description="operating conditions by name, in the unit of the machine's document"
    )


class RunCoverage(BaseModel):
    """Speeds, critical speeds and time that the samples of a run cover."""

    part: float = Field(description="of the machine's speed range, 0 to 1")
    critical_speeds_rpm: list[float] | None = Field(
        description="of the document's nominal model, between the run's speeds; null until it was identified"
    )
    samples_per_rpm: float
    largest_hole_rpm: float = Field(description="between neighbours in speed")
    usable: dict[str, float] = Field(description="per channel the part of the samples that are good, 0 to 1")
    duration_s: float
    late_samples_left_out: int = Field(description="they came after the run's raw samples had been deleted")


class QualitySummary(BaseModel):
    """Summary of a run's quality."""

    points: int = Field(description="phasors, samples times channels")
    usable: int
    counts: dict[str, int] = Field(description="phasors by reason")
    findings: list[str] = Field(description="what there is to say of the run, in words")


class ChannelNoise(BaseModel):
    """Noise of a channel, estimated from neighbouring speeds; null where there are too few points."""

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


class DwellsIn(StrictModel):
    """A time range in which a machine was held at one or several constant speeds, with one set of trial weights."""

    first: Moment = Field(alias="from", description="of the first sample, RFC 3339 with its zone")
    last: Moment = Field(alias="to", description="of the last sample")
    by: Author

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        if self.first > self.last:
            raise ValueError("from lies behind to: exchange them")
        return self


class Run(BaseModel):
    """A run-up, a run-down, a rolling collection over speed bins, or dwells that somebody made a run of."""

    id: int
    machine: str
    revision: int
    kind: str
    direction: str
    state: str = Field(
        description="open, ended while its samples are gathered, closed, or discarded as not worth an identification; runs of "
        "dwells are discarded, too, since they are identified on request only"
    )
    reason: str | None = Field(description="why it ended, and why it was discarded")
    started_at: datetime
    ended_at: datetime | None
    samples: int | None
    speed_minimum_rpm: float | None
    speed_maximum_rpm: float | None
    reopened_at: datetime | None = Field(description="when late samples last rebuilt it; its newest identification counts")
    samples_released_at: datetime | None = Field(description="when its samples were deleted; null while it has them")
    coverage: RunCoverage | None = Field(description="null until it is closed, and for runs of older releases")
    quality: QualitySummary | None = Field(description="null until it was judged")


class SampleFault(BaseModel):
    """A sample, or one channel's value in it, that was rejected."""

    index: int = Field(description="its place in the batch")
    reason: str
    detail: str


class Submitted(BaseModel):
    """Outcome of a batch; all of it is durable."""

    received: int = Field(description="samples stored now")
    duplicates: int = Field(description="samples that were stored before")
    missing_before: int = Field(description="sequence numbers left out just before this batch: counted as lost")
    faults: list[SampleFault]
    ignored: list[str] = Field(description="fields of the batch that there are not, each with what was probably meant")
