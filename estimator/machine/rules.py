"""Rules of the machine document: operation of the machine, collection of runs, and what a fit may do and expects."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from estimator.field_types import Identifier, NotNegative, Part, Positive, SmallLength, Text, VibrationLimit, Within
from estimator.machine.alignment_rules import AlignmentTarget, AlignmentTolerance, HealthyVariation


class Condition(Part):
    """An operating condition that samples may carry beside the phasors, such as load or oil temperature."""

    name: Identifier
    unit: Annotated[Text, Field(min_length=1, max_length=16)] = Field(description="in which it comes, such as degC or %")
    usual_change: Positive | None = Field(
        default=None,
        description="a change that is nothing unusual, in its unit; by default 10 for degC and K, 20 for %, "
        "else its own scatter in the baseline",
    )


class SpeedRange(Part):
    """Speeds at which samples are taken seriously [r/min]."""

    minimum_rpm: Positive = Field(description="below this a run-down is over [r/min]")
    maximum_rpm: Positive = Field(description="trip speed or what the machine can never exceed [r/min]")

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.minimum_rpm >= self.maximum_rpm:
            raise ValueError(f"minimum_rpm {self.minimum_rpm} must be below maximum_rpm {self.maximum_rpm}")
        return self

    @property
    def middle_rpm(self) -> float:
        """Return the speed in the middle of the range [r/min]."""
        return (self.minimum_rpm + self.maximum_rpm) / 2


class SeverityZones(Part):
    """Boundaries between zones of severity of the overall level at running speed, 0-to-peak [m], with their source."""

    source: Annotated[Text, Field(min_length=1, max_length=200)] = Field(
        description="where the boundaries come from: a standard with its part and edition, the maker's manual, a contract"
    )
    a_b: VibrationLimit = Field(description="between zones A and B, 0-to-peak [m]: half of a peak-to-peak value")
    b_c: VibrationLimit = Field(description="between zones B and C, 0-to-peak [m]")
    c_d: VibrationLimit = Field(description="between zones C and D, 0-to-peak [m]")

    @model_validator(mode="after")
    def _ascending(self) -> Self:
        if not self.a_b < self.b_c < self.c_d:
            raise ValueError(f"a_b {self.a_b:g}, b_c {self.b_c:g} and c_d {self.c_d:g} must ascend")
        return self

    def zone(self, level: float) -> Literal["A", "B", "C", "D"]:
        """Return the zone of an overall level; a boundary belongs to the better zone.

        Args:
            level: The level, 0-to-peak [m].

        Returns:
            Its zone, A to D [-].
        """
        if level <= self.a_b:
            return "A"
        if level <= self.b_c:
            return "B"
        return "C" if level <= self.c_d else "D"


class Operation(Part):
    """Operation of the machine, as far as its runs cannot be told from the speed alone."""

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
    vibration_limit: VibrationLimit | None = Field(
        default=None, description="largest 1× vibration that a balanced machine may have at any probe, 0-to-peak [m]"
    )
    vibration_alert: VibrationLimit | None = Field(
        default=None, description="1× vibration at any probe from which a person should look, 0-to-peak [m]"
    )
    vibration_danger: VibrationLimit | None = Field(
        default=None, description="1× vibration at any probe from which the machine is in danger, 0-to-peak [m]"
    )
    severity_zones: SeverityZones | None = Field(
        default=None, description="zones of the overall levels that sources send, at `running_rpm`; by default none"
    )
    longest_hold_s: Annotated[float, Within(ge=10, le=604_800)] = Field(
        default=3600.0, description="a sweep that stands still on its way for longer, as in a heat soak, is over [s]"
    )
    longest_pause_s: Annotated[float, Within(ge=1, le=86_400)] = Field(
        default=120.0, description="a pause in the data that is longer ends a run [s]"
    )
    alignment_tolerances: Annotated[tuple[AlignmentTolerance, ...], Field(max_length=20)] = Field(
        default=(), description="what is allowed at couplings of a train on oil films; by default what is usual at its speed"
    )
    alignment_targets: Annotated[tuple[AlignmentTarget, ...], Field(max_length=20)] = Field(
        default=(), description="alignment of couplings of a train on oil films as left cold, and its expected growth"
    )
    healthy_variation: HealthyVariation = Field(
        default=HealthyVariation.model_construct(),
        description="of a train on oil films, or a calibrated one, as long as nothing happens to it",
    )

    @model_validator(mode="after")
    def _alert_below_danger(self) -> Self:
        alert, danger = self.vibration_alert, self.vibration_danger
        if alert is not None and danger is not None and alert >= danger:
            raise ValueError(f"vibration_alert {alert:g} must be below vibration_danger {danger:g}")
        return self

    @model_validator(mode="after")
    def _zones_at_a_speed(self) -> Self:
        if self.severity_zones is not None and self.running_rpm is None:
            raise ValueError("severity_zones hold at running speed: name running_rpm, too")
        return self


class RollingCollection(Part):
    """Bins over the speed range that are filled as the speed wanders, and when they make a run."""

    bins: Annotated[int, Field(ge=5, le=200)] = Field(default=40, description="number of bins over the speed range")
    samples_per_bin: Annotated[int, Field(ge=1, le=50)] = Field(default=5, description="the newest ones kept in each")
    spacing_s: Annotated[float, Within(ge=0, le=86_400)] = Field(
        default=1.0, description="least time between two samples of a bin [s]"
    )
    recency_s: Annotated[float, Within(ge=60, le=31_622_400)] = Field(
        default=604_800.0, description="samples older than this are left out [s]"
    )
    coverage: Annotated[float, Within(gt=0, le=1, usual=(0.3, 0.9))] = Field(
        default=0.6, description="part of the bins that must hold samples [-]"
    )
    interval_s: Annotated[float, Within(ge=10, le=31_622_400)] = Field(
        default=86_400.0, description="at most one run in this time [s]"
    )


class Collection(Part):
    """Collection of samples into runs."""

    runs: Literal["sweeps", "rolling", "both"] = Field(
        default="sweeps", description="run-ups and run-downs, collections over speed bins, or both"
    )
    pre_trigger_s: Annotated[float, Within(ge=0, le=3600)] = Field(
        default=5.0, description="samples so shortly before a run began belong to it [s]"
    )
    delta_rpm: Positive | None = Field(
        default=None, description="a run keeps a sample when the speed has changed by this [r/min] …"
    )
    delta_s: Positive | None = Field(
        default=None, description="… or when this time has passed since the last one kept [s]; by default every sample"
    )
    rolling: RollingCollection = RollingCollection.model_construct()


class QualityRules(Part):
    """Points of a run that an identification leaves out, beside those that no fit should use."""

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


class Noise(Part):
    """Expected measurement error of a phasor: rms of the complex error, sqrt((relative·|X|)² + floor²)."""

    relative: Annotated[float, Within(gt=0, lt=1, usual=(0.002, 0.1))] = Field(
        default=0.01, description="part of the amplitude [-]"
    )
    floor: SmallLength = Field(default=1e-7, description="0-to-peak [m]")
    estimated: bool = Field(
        default=False, description="find both parts from the fit's own residuals; the values above are where that starts"
    )


class Centreline(Part):
    """Expectations of the gaps that samples may carry: the shaft's mean place over the run, from a zero of each probe."""

    noise: Annotated[float, Within(gt=0, lt=1e15, usual=(1e-9, 5e-5))] = Field(
        default=1e-6, description="rms error of a gap [m]; where neighbouring samples scatter more, that counts"
    )
    drift: SmallLength = Field(
        default=5e-6,
        description="rms drift of a probe's zero over a run [m]: a holder of 100 mm that cools by 4 K shrinks by 5 µm",
    )


class ParameterRule(Part):
    """Rule on some parameters of an identification. Later rules win over earlier ones."""

    names: Annotated[Text, Field(min_length=1, max_length=200)] = Field(
        description="a parameter's name or a pattern, such as coupling.C1.k_phi*"
    )
    fixed: bool = Field(default=False, description="keep the nominal value")
    spread: Annotated[float, Within(gt=0, lt=1e15, usual=(0.01, 1))] | None = Field(
        default=None,
        description="how far from the nominal value, rms [-]: of a direct term's logarithm, else part of the value, or of the "
        "direct terms beside a cross-coupled term of zero",
    )
    tied_to: str | None = Field(default=None, description="element whose coefficients of the same names it takes: bearing.B1")

    @model_validator(mode="after")
    def _one_meaning(self) -> Self:
        if self.fixed + (self.spread is not None) + (self.tied_to is not None) != 1:
            raise ValueError("give exactly one of fixed, spread, tied_to")
        return self


class ImpactTest(Part):
    """Natural frequencies of the train at standstill, measured with a hammer."""

    frequencies_hz: Annotated[tuple[Positive, ...], Field(min_length=1, max_length=100)] = Field(description="[Hz]")
    relative_error: Annotated[float, Within(gt=0, lt=1, usual=(0.002, 0.1))] = Field(default=0.01, description="rms [-]")
