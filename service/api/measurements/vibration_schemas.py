"""Models of the vibration at the probes: newest values, and the trend at running speed."""

from datetime import datetime
from typing import Literal

from pydantic import BaseModel, Field

Zone = Literal["A", "B", "C", "D"]
"""Zone of severity of an overall level."""


class ZoneBoundaries(BaseModel):
    """Boundaries of severity zones from the document, for overall levels at running speed, peak-to-peak [µm]."""

    source: str = Field(description="where the document has them from")
    a_b_um_pp: float
    b_c_um_pp: float
    c_d_um_pp: float


class VibrationLimits(BaseModel):
    """Levels of the 1× from the document, peak-to-peak [µm]; null where it gives none."""

    balanced_um_pp: float | None = Field(description="largest that a balanced machine may have (operation.vibration_limit)")
    alert_um_pp: float | None = Field(description="from which a person should look (operation.vibration_alert)")
    danger_um_pp: float | None = Field(description="from which the machine is in danger (operation.vibration_danger)")
    severity_zones: ZoneBoundaries | None = Field(
        default=None, description="of overall levels (operation.severity_zones); null where the document gives none"
    )


class VibrationVector(BaseModel):
    """One order's vector."""

    amplitude_um_pp: float
    phase_lag_deg: float = Field(description="behind the keyphasor [°], 0 to 360; of the 2× in degrees of the 2×")


class ProbeVibration(BaseModel):
    """The newest good 1× of a probe with what was sent beside it; nothing where the newest samples hold none."""

    channel: str
    time: datetime | None = None
    speed_rpm: float | None = None
    first: VibrationVector | None = Field(default=None, description="1×")
    second: VibrationVector | None = Field(default=None, description="2×; null where the source sends none")
    overall_um_pp: float | None = Field(default=None, description="unfiltered; null where the source sends none")
    zone: Zone | None = Field(
        default=None, description="of the overall level; null without one, without zones, or away from running speed"
    )
    gap_um: float | None = Field(
        default=None, description="mean place of the shaft towards the probe, from a zero of the probe's own; null: not sent"
    )


class MachineVibration(BaseModel):
    """Newest vibration of a machine."""

    machine: str
    slow_roll_version: int | None = Field(default=None, description="vectors subtracted from the 1×; null: as measured")
    slow_roll_left_out: dict[str, str] = Field(default_factory=dict, description="channels left as measured, and why")
    limits: VibrationLimits
    probes: list[ProbeVibration]


class Region(BaseModel):
    """Ellipse in the plane of the 1× vector in which the next run's lies with 95 % while nothing happens.

    A vector of amplitude A and phase lag φ lies at real A cos φ, imaginary -A sin φ.
    """

    run_kind: str
    runs: int = Field(description="first runs of the baseline that it is made of")
    centre_real_um_pp: float
    centre_imaginary_um_pp: float
    semi_major_um_pp: float
    semi_minor_um_pp: float
    inclination_deg: float = Field(description="of the major axis, from the real one towards the imaginary one")


class ProbeTrend(BaseModel):
    """Trend of one probe; all lists have one entry per run, oldest first."""

    channel: str
    run: list[int]
    run_kind: list[str]
    measured_at: list[datetime] = Field(description="when the run ended")
    speed_rpm: list[float] = Field(description="mean speed of the samples that were averaged")
    amplitude_um_pp: list[float | None]
    phase_lag_deg: list[float | None]
    amplitude_2x_um_pp: list[float | None]
    phase_2x_lag_deg: list[float | None]
    second_over_first: list[float | None]
    overall_um_pp: list[float | None] = Field(description="unfiltered, mean over the samples; null where not sent")
    zone: list[Zone | None] = Field(description="of the overall level; null without one, or without zones")
    gap_um: list[float | None] = Field(description="mean place of the shaft towards the probe; null where not sent")
    within: list[bool | None] = Field(description="whether the 1× lies in the acceptance region; null where there is none")
    regions: list[Region] = Field(description="none until the baseline has its runs")


class VibrationTrend(BaseModel):
    """Vibration at running speed, run by run."""

    machine: str
    running_rpm: float | None = Field(description="null where there is no run")
    running_speed_named: bool = Field(
        default=False, description="whether the document names it; else the lowest of the runs' highest speeds"
    )
    slow_roll_version: int | None = None
    slow_roll_left_out: dict[str, str] = Field(default_factory=dict)
    limits: VibrationLimits
    probes: list[ProbeTrend]
