"""Models of deviations from baselines and of their trends."""

from datetime import datetime

from pydantic import BaseModel, Field

from service.api.findings.evidence import MeanSizeOut


class BaselineUsed(BaseModel):
    """The baseline that an identification is compared with."""

    identifications: list[int]
    wanted: int = Field(description="how many make it")
    since: datetime | None = Field(description="null: the machine's first runs")
    reason: str | None
    by: str | None


class ComparedOut(BaseModel):
    """An identification with its baseline."""

    machine: str
    identification: int
    measured_at: datetime
    run_kind: str
    conditions: dict[str, float | None] | None = Field(description="operating conditions, means over the run")
    adjusted_for: list[str] = Field(
        description="conditions under whose baseline means all is compared; empty where the baseline has too few of them"
    )
    baseline: BaselineUsed
    missing: str | None = Field(description="why nothing can be compared yet")
    left_out: dict[str, str] = Field(description="parameters that are not compared, and why")


class ParameterDeviationOut(BaseModel):
    """Deviation of one parameter from its baseline."""

    parameter: str
    element: str
    per_cent: float = Field(
        description="of its baseline; of a cross-coupled term of the direct terms beside it; of an unbalance the vector's "
        "change, of its magnitude"
    )
    lower_per_cent: float = Field(description="of the 95 % interval")
    upper_per_cent: float
    sigma: float = Field(description="in standard deviations; of an unbalance the distance of both components")
    degrees_of_freedom: float = Field(description="with which the standard deviation is known")
    probability: float = Field(description="of one as large, either way, while nothing has changed")
    added: float | None = Field(description="of an unbalance: magnitude of what came on top [kg m]; else null")
    added_angle_deg: float | None = Field(description="and its angle from the keyphasor mark, from +x towards +y")
    reaches: str | None = Field(description="alert or danger, by the limits of its element's rule")


class ElementDistanceOut(BaseModel):
    """Joint distance of all parameters of an element."""

    element: str
    coordinates: list[str]
    distance: float = Field(description="Mahalanobis; about the root of the number of coordinates while nothing has changed")
    degrees_of_freedom: float
    probability: float
    together: list[MeanSizeOut] = Field(
        default_factory=list,
        description="by how much the element has changed as a whole, where the diagnosis under the same identification says "
        "so: the figures of its alert, from the newest runs together",
    )


class DeviationsOut(ComparedOut):
    """Deviations of an identification from its baseline."""

    parameters: list[ParameterDeviationOut]
    elements: list[ElementDistanceOut]


class ChartOut(BaseModel):
    """State of a control chart after the newest run."""

    value: float
    limit: float
    passed: bool
    began: datetime | None = Field(description="of a step that is there: its likeliest first run")
    runs: int | None = Field(description="from that one on; fewer than six do not tell a step from a drift")


class AheadOut(BaseModel):
    """Weeks until a limit is reached at the present drift; null: never, or not within a century."""

    per_cent: float = Field(description="the limit")
    expected: float | None
    earliest: float | None = Field(description="by the drift's 95 % interval")
    latest: float | None


class DriftOut(BaseModel):
    """A slow drift: in per cent, as deviations are; for an element's distance in units of the distance."""

    per_week: float
    lower: float = Field(description="of the 95 % interval")
    upper: float
    probability: float = Field(description="of such an order of the runs without a drift, after Hamed and Rao")
    correction: float = Field(description="factor on the test's variance for serial correlation")
    alert: AheadOut | None = Field(description="null where no limit is set")
    danger: AheadOut | None


class TrendTestOut(BaseModel):
    """Trend of one coordinate, or of an element's distance, over the runs since the baseline."""

    name: str = Field(description="a parameter, a component of an unbalance, or an element")
    runs: int
    newest: float = Field(description="per cent; of an element its distance")
    step_up: ChartOut = Field(description="CUSUM")
    step_down: ChartOut | None = Field(description="null for a distance, which can only grow")
    creep: ChartOut = Field(description="EWMA; its sign is the sense")
    drift: DriftOut | None = Field(description="null for fewer than four runs")


class TrendTestsOut(ComparedOut):
    """Trend tests of parameters and elements."""

    run_length: float = Field(description="identifications between two false alarms of one chart, on average")
    tests: list[TrendTestOut]
