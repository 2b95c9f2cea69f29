"""Serves the state of each monitoring stage, from acquisition to advice, after the blocks of ISO 13374-1."""

from collections.abc import Mapping
from datetime import datetime
from typing import Literal

from fastapi import APIRouter, Request
from pydantic import BaseModel, Field

from service.api.conventions.dependencies import Reading
from service.api.conventions.values import time_or_none
from service.security.requirement import VIEWER
from storage.clock import now, to_datetime
from storage.operation.pipeline_stages import StageFigures, figures

router = APIRouter(tags=["operations"], dependencies=[VIEWER])

A_DAY_NS = 24 * 3600 * 1_000_000_000
AN_HOUR_NS = 3600 * 1_000_000_000

StageState = Literal["ok", "degraded", "failed", "idle"]


class Stage(BaseModel):
    """One stage. failed: it does not work; degraded: it works in part; idle: nothing came to it in the last day."""

    stage: Literal[
        "data_acquisition",
        "data_manipulation",
        "state_detection",
        "health_assessment",
        "prognostic_assessment",
        "advisory_generation",
    ]
    state: StageState
    words: str = Field(description="why it is in this state")
    latest: datetime | None = Field(description="when it last did something")
    figures: dict[str, int] = Field(description="of the last day; `…_now` of this moment, `…_ever` of all time")


class Stages(BaseModel):
    """All stages, in the order in which the data pass them."""

    since: datetime
    stages: list[Stage]


@router.get("/health/stages", operation_id="read_stages")
def read_stages(request: Request, session: Reading) -> Stages:
    """Report the state of acquisition, manipulation, state detection, health assessment, prognosis and advice."""
    moment = now()
    parts: dict[str, str] = request.app.state.parts()
    held = figures(session, since=moment - A_DAY_NS, overdue=moment - AN_HOUR_NS)
    made = (_acquisition, _manipulation, _detection, _assessment, _prognosis, _advice)
    return Stages(since=to_datetime(moment - A_DAY_NS), stages=[stage(held, parts) for stage in made])


def _acquisition(held: StageFigures, parts: Mapping[str, str]) -> Stage:
    state, words = _state(parts, "ingest", busy=held.sending_machines > 0, idle="no machine sent samples in the last day")
    if state in ("ok", "idle") and parts.get("stream", "ok") != "ok":
        state, words = "degraded", parts["stream"]
    elif state == "ok" and held.rejected:
        state, words = "degraded", "input was rejected: the quarantine says what and why"
    elif state == "ok" and held.sending_machines < held.machines_now:
        state, words = "degraded", f"{held.machines_now - held.sending_machines} machines sent nothing in the last day"
    return Stage(
        stage="data_acquisition",
        state=state,
        words=words,
        latest=time_or_none(held.newest_sample),
        figures=_selected(held, "machines_now", "sending_machines", "rejected", "lost_ever"),
    )


def _manipulation(held: StageFigures, parts: Mapping[str, str]) -> Stage:
    """Report on the stage that turns samples into runs, and runs into parameters."""
    busy = held.runs > 0 or held.identifications > 0
    state, words = _state(parts, "identifying", busy=busy, idle="no run began in the last day")
    if state in ("ok", "idle") and held.failed_jobs:
        state, words = "degraded", "identifications failed: the machines' jobs say why"
    return Stage(
        stage="data_manipulation",
        state=state,
        words=words,
        latest=time_or_none(_latest(held.newest_run, held.newest_identification)),
        figures=_selected(held, "runs", "open_runs_now", "waiting_jobs_now", "failed_jobs", "identifications"),
    )


def _detection(held: StageFigures, parts: Mapping[str, str]) -> Stage:
    """Report on the stage that assesses parameters: the fit of the model and the distance from the baseline."""
    idle = "nothing was identified in the last day"
    state, words = _state(parts, "identifying", busy=held.identifications > 0, idle=idle)
    if state == "ok" and held.accepted < held.identifications:
        refused = held.identifications - held.accepted
        state, words = "degraded", f"{refused} identifications do not fit their runs and say nothing of their machines"
    return Stage(
        stage="state_detection",
        state=state,
        words=words,
        latest=time_or_none(held.newest_identification),
        figures=_selected(held, "identifications", "accepted"),
    )


def _assessment(held: StageFigures, parts: Mapping[str, str]) -> Stage:
    idle = "nothing was diagnosed in the last day: no accepted run came, or baselines are not complete"
    state, words = _state(parts, "identifying", busy=held.diagnoses > 0, idle=idle)
    return Stage(
        stage="health_assessment",
        state=state,
        words=words,
        latest=time_or_none(held.newest_diagnosis),
        figures=_selected(held, "diagnoses"),
    )


def _prognosis(held: StageFigures, parts: Mapping[str, str]) -> Stage:
    """Report on prognosis, which trend-tests compute on request and never store."""
    busy = held.newest_diagnosis is not None
    state, words = _state(parts, "database", busy=busy, idle="no machine has a complete baseline yet")
    if state == "ok":
        words = "times to limits are computed when trend-tests are asked for"
    return Stage(stage="prognostic_assessment", state=state, words=words, latest=None, figures={})


def _advice(held: StageFigures, parts: Mapping[str, str]) -> Stage:
    busy = held.newest_alert is not None
    state, words = _state(parts, "delivery", busy=busy, idle="there was no alert yet")
    if state == "ok" and (held.given_up_deliveries or held.overdue_deliveries_now):
        state, words = "degraded", "messages do not reach their receivers: the subscriptions' deliveries say which"
    return Stage(
        stage="advisory_generation",
        state=state,
        words=words,
        latest=time_or_none(held.newest_alert),
        figures=_selected(held, "open_alerts_now", "waiting_deliveries_now", "overdue_deliveries_now", "given_up_deliveries"),
    )


def _state(parts: Mapping[str, str], part: str, *, busy: bool, idle: str) -> tuple[StageState, str]:
    """Return the state of a stage from the part that does its work and from its activity; an absent part counts as ok."""
    words = parts.get(part, "ok")
    if words != "ok":
        return "failed", f"{part}: {words}"
    return ("ok", "works") if busy else ("idle", idle)


def _latest(*moments: int | None) -> int | None:
    return max((one for one in moments if one is not None), default=None)


def _selected(held: StageFigures, *names: str) -> dict[str, int]:
    return {name: getattr(held, name) for name in names}
