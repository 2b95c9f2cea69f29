"""Models of the evidence behind diagnoses and alerts."""

import math
from collections.abc import Mapping
from datetime import datetime
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BaseModel, Field

from estimator.diagnosis.finding_kinds import FINDING_KINDS
from estimator.machine.parameter_description import is_direct
from estimator.rotor.parameter_names import change_unit
from service.monitoring.rules.drift_rule import RATE_OF_CHANGE

if TYPE_CHECKING:
    RateKind = str
else:
    RateKind = Literal[RATE_OF_CHANGE.name]
*_FIRST, _LAST = [one.kind for one in FINDING_KINDS]


class Moved(BaseModel):
    """A parameter, or a component of a vector, that has changed."""

    parameter: str
    change: float | None = Field(
        description="against the baseline, in its unit; of a vector its length; null where an older release stored a logarithm"
    )
    unit: str | None = Field(description="SI unit of the change; null: the document has no such parameter")
    per_cent: float | None = Field(default=None, description="as deviations have it, under the same identification")
    lower_per_cent: float | None = Field(default=None, description="of the 95 % interval")
    upper_per_cent: float | None = Field(default=None)
    sigma: float = Field(description="the change in its standard errors")


def with_moved_in_per_cent(stored: dict[str, Any], units: Mapping[str, str]) -> dict[str, Any]:
    """Return the evidence of a cause with what has moved in per cent: releases before 0.9 stored logarithms of direct terms.

    units: SI unit of each parameter.
    """
    return stored | {"moved": [_moved_in_per_cent(one, units) for one in stored.get("moved") or ()]}


def _moved_in_per_cent(one: dict[str, Any], units: Mapping[str, str]) -> dict[str, Any]:
    name = one["parameter"]
    if "per_cent" in one:
        return one
    if not is_direct(name):
        return {"unit": change_unit(name, units)} | one
    return one | {"change": None, "unit": units.get(name), "per_cent": 100.0 * math.expm1(one["change"])}


class RunnerUp(BaseModel):
    """Another cause that explains the runs less well."""

    kind: str
    element: str
    evidence: float


class SecondOrderOut(BaseModel):
    """A 2× near running speed that has grown beside a coupling, and at no probe elsewhere; it raises no alert by itself."""

    probe: str
    before_um: float = Field(description="amplitude in the baseline, 0-to-peak")
    now_um: float = Field(description="amplitude in the newest run, 0-to-peak")
    decided: bool = Field(description="whether it decided between two explanations that are about as good as each other")


class SizeOut(BaseModel):
    """A figure of a cause's size with its 95 % interval."""

    name: str = Field(description="what has changed; coupling.C1.coefficients: all coefficients of C1 together")
    unit: str
    value: float
    lower: float
    upper: float
    sigma: float | None = None
    allowed: float | None = Field(default=None, description="what is allowed of it")
    before: float | None = Field(default=None, description="in the baseline")
    members: list[str] = Field(default_factory=list, description="parameters that have changed together")
    against: str = Field(default="baseline", description="what it is told against: `baseline`, or `runs_before` a step")


class MeanSizeOut(SizeOut):
    """A figure of a cause's size that is the mean of several runs."""

    runs: int | None = Field(description="newest runs whose mean it is; null: of an older release")


class AheadLimit(BaseModel):
    """A danger limit that is not reached, and the weeks until it is at the present rate; null: never, or not certainly."""

    limit: float
    expected: float | None
    earliest: float | None
    latest: float | None


class CauseProgress(BaseModel):
    """A cause since it began, in per cent of the baseline, on oil films of what is allowed."""

    runs: int = Field(description="since it began, of those that tell of it")
    newest: float | None = Field(description="size that the newest of them shows")
    per_week: float | None = Field(description="null for fewer than four runs")
    lower: float | None = Field(description="of the 95 % interval")
    upper: float | None
    ahead: AheadLimit | None


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
    tolerance_per_cent: float | None = Field(default=None, description="on oil films: of what is allowed")
    parts: list[SizeOut] = Field(default_factory=list, description="figures of its size, the one that matters most first")
    progress: CauseProgress | None = Field(default=None, description="null: of an older release")
    moved: list[Moved] = Field(
        description="parameters of its elements that the newest run determines, the surest first; at most four of each element"
    )
    not_estimable: list[str] = Field(default_factory=list, description="parameters of its element that it does not determine")
    runners_up: list[RunnerUp] = Field(default_factory=list)
    second_order: SecondOrderOut | None = Field(
        default=None, description="growth of the 2× that speaks for it, rather than for an explanation that is nearly as good"
    )


class AlertedCause(CauseOut):
    """A cause that reached a limit, as the newest run shows it."""

    identification: int = Field(description="the run's that showed it last")
    measured_at: datetime | None = Field(default=None, description="when that was measured; null: of an older release")
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
    change_per_cent: float | None = Field(default=None, description="so far against the baseline, as trend tests have it")
    ahead: AheadLimit | None = Field(default=None, description="the danger limit of its size")
    identification: int = Field(description="the run's that showed it last")
    measured_at: datetime | None = Field(default=None, description="when that was measured; null: of an older release")
    run_kind: str = Field(description="run-up, run-down or rolling; only runs of this kind can end it")


AlertEvidence = Annotated[
    AlertedCause | AlertedRate | dict[str, Any],
    Field(
        union_mode="left_to_right",
        description="a cause of a diagnosis, or a rate of change; what an older release stored is answered as it was stored",
    ),
]
