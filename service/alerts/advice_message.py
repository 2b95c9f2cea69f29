"""The form in which findings are reported everywhere: in the API, in streams and in deliveries."""

from datetime import datetime

from pydantic import BaseModel, Field


class Figure(BaseModel):
    """A figure of how far something has changed, with its 95 % interval."""

    of: str = Field(description="what has changed, such as bearing.B2.clearance; coupling.C1.coefficients: all together")
    words: str
    unit: str = Field(description="µm, mrad, N, g·mm, % …")
    value: float
    lower: float = Field(description="of the 95 % interval")
    upper: float
    sigma: float | None = Field(description="in standard errors, where that is said")
    runs: int | None = Field(description="newest runs whose mean it is; null: of an older release")
    allowed: float | None = Field(description="what is allowed of it, in the unit")
    before: float | None = Field(description="value in the baseline, in the unit")
    against: str = Field(default="baseline", description="what it is told against: `baseline`, or `runs_before` a step")
    parameters: list[str] = Field(description="parameters whose common change it is, of those that the newest run determines")


class Certainty(BaseModel):
    """Certainty of a finding."""

    words: str
    sigma: float | None
    runs: int | None = Field(description="newest runs that were looked at together")
    evidence: float | None = Field(description="logarithm of the factor by which it makes these runs more probable")
    next_best: str | None = Field(description="the explanation that comes next")


class Urgency(BaseModel):
    """Time until the danger limit, at the rate since the change began; null: no time can be given."""

    words: str
    unit: str | None = Field(description="of the rate and the limit")
    per_week: float | None
    per_week_lower: float | None = Field(description="of the 95 % interval")
    per_week_upper: float | None
    limit: float | None = Field(description="the danger limit")
    reached: bool = Field(description="whether the danger limit is reached")
    weeks: float | None = Field(description="from the newest run to the limit")
    weeks_earliest: float | None = Field(description="by the rate's 95 % interval")
    weeks_latest: float | None
    by: datetime | None = Field(description="the day by which that is")


class Action(BaseModel):
    """An action, and the opportunity for it."""

    opportunity: str = Field(description="now, in operation, or at the next stop")
    text: str


class Advice(BaseModel):
    """Advice on a finding. Texts are the service's or the site's own."""

    what: str = Field(description="what it is")
    how_far: list[Figure] = Field(description="the figure that matters most first; empty where it has no size")
    how_sure: Certainty
    how_urgent: Urgency
    check: list[str] = Field(description="what to look at")
    actions: list[Action] = Field(description="the most urgent first")
    confirm: list[str] = Field(description="what would confirm it")
    not_determined: list[str] = Field(description="what this does not tell")
