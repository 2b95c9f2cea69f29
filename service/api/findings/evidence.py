"""Models of the evidence behind diagnoses and alerts."""

from datetime import datetime
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BaseModel, Field

from estimator.diagnosis.finding_kinds import FINDING_KINDS
from service.monitoring.finding_rules import RATE_OF_CHANGE

if TYPE_CHECKING:
    RateKind = str
else:
    RateKind = Literal[RATE_OF_CHANGE.name]
*_FIRST, _LAST = [one.kind for one in FINDING_KINDS]


class Moved(BaseModel):
    """A parameter, or a component of a vector, that has changed."""

    parameter: str
    change: float = Field(description="of direct terms the logarithm of the factor, of all others the difference")
    unit: str | None = Field(description="SI unit of the change; null: the document has no such parameter")
    sigma: float = Field(description="the change in its standard errors")


class RunnerUp(BaseModel):
    """Another cause that explains the runs less well."""

    kind: str
    element: str
    evidence: float


class CauseOut(BaseModel):
    """A cause of a change of the machine."""

    kind: str = Field(description=f"{', '.join(_FIRST)} or {_LAST}")
    element: str
    evidence: float = Field(description="logarithm of the factor by which it makes the runs more probable")
    sigma: float = Field(description="the whole change in its standard errors")
    per_cent: float | None = Field(
        default=None, description="of what the element was in the baseline; null where the cause has no size"
    )
    quantities: dict[str, float] = Field(default_factory=dict, description="its size, by name with the unit at its end")
    form: str | None = Field(default=None, description="of a misalignment: parallel, angular or combined, where the data tell")
    misalignment_force: float | None = Field(default=None, description="in the coupling at running speed [N]")
    since: datetime = Field(description="when the first run that shows it was measured")
    first_identification: int | None = Field(default=None, description="that run's")
    runs: int | None = Field(default=None, description="newest runs that were looked at together; null: of an older release")
    moved: list[Moved] = Field(description="the surest first; at most four of each element")
    runners_up: list[RunnerUp] = Field(default_factory=list)


class AlertedCause(CauseOut):
    """A cause that reached a limit, as the newest run shows it."""

    identification: int = Field(description="the run's that showed it last")
    run_kind: str = Field(description="run-up, run-down or rolling; only runs of this kind can end it")
    baseline: list[int] = Field(description="ids of the identifications that it was compared with")


class AlertedRate(BaseModel):
    """A parameter that changes too fast."""

    kind: RateKind
    element: str
    parameter: str = Field(description="the element's parameter that changes fastest")
    runs: int = Field(description="newest runs that the rate was taken from")
    per_week_per_cent: float
    lower_per_cent: float = Field(description="lower 95 % bound of the rate, per week")
    upper_per_cent: float = Field(description="upper 95 % bound of the rate, per week")
    identification: int = Field(description="the run's that showed it last")
    run_kind: str = Field(description="run-up, run-down or rolling; only runs of this kind can end it")


AlertEvidence = Annotated[
    AlertedCause | AlertedRate | dict[str, Any],
    Field(
        union_mode="left_to_right",
        description="a cause of a diagnosis, or a rate of change; what an older release stored is answered as it was stored",
    ),
]
